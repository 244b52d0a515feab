#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "base/error.h"

namespace gusset {

/// Reads one field of a JSON object that a user may have edited.
/// @throws InputError `key is missing`, `key must be ...` or `key = v is not within [lo, hi]`.
template <class T>
T JsonField(const nlohmann::json& object, const std::string& key) {
  if (!object.is_object() || !object.contains(key)) throw InputError(key + " is missing");
  const nlohmann::json& value = object.at(key);
  bool fits = true;
  if constexpr (std::is_same_v<T, bool>) {
    fits = value.is_boolean();
  } else if constexpr (std::is_integral_v<T>) {
    fits = value.is_number_integer();
  } else if constexpr (std::is_floating_point_v<T>) {
    fits = value.is_number() && std::isfinite(value.get<double>());
  } else if constexpr (std::is_same_v<T, std::string>) {
    fits = value.is_string();
  } else if constexpr (std::is_same_v<T, nlohmann::json::array_t>) {
    fits = value.is_array();
  }
  if (!fits) throw InputError(key + " = " + value.dump() + " has the wrong type");
  return value.get<T>();
}

/// As above, with inclusive bounds.
template <class T>
T JsonField(const nlohmann::json& object, const std::string& key, T lo, T hi) {
  const T value = JsonField<T>(object, key);
  if (value < lo || value > hi) {
    throw InputError(key + " = " + object.at(key).dump() + " is not within [" +
                     nlohmann::json(lo).dump() + ", " + nlohmann::json(hi).dump() + "]");
  }
  return value;
}

}  // namespace gusset
