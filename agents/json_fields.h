#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "base/error.h"

namespace gusset {

/// What a user may have edited is refused beyond this depth of objects and arrays: nothing here has
/// more than ten, and the library that reads them needs stack for each.
constexpr int kMostJsonDepth = 64;

/// @throws nlohmann::json::exception if it is not JSON, InputError if it is nested too deep.
inline nlohmann::json ParseJson(std::string_view text) {
  return nlohmann::json::parse(
      text, [](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
        if (depth <= kMostJsonDepth) return true;
        throw InputError("is nested deeper than " + std::to_string(kMostJsonDepth) + " levels");
      });
}

/// A document for people and programs; names of files in it that are not UTF-8, which JSON cannot
/// hold, get replacement signs.
inline std::string JsonText(const nlohmann::ordered_json& document) {
  return document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

/// Reads one field of a JSON object that a user may have edited.
/// @throws InputError `key is missing`, `key = v has the wrong type or size` or `key = v is not
/// within [lo, hi]`.
template <class T>
T JsonField(const nlohmann::json& object, const std::string& key) {
  if (!object.is_object() || !object.contains(key)) throw InputError(key + " is missing");
  const nlohmann::json& value = object.at(key);
  bool fits = true;
  if constexpr (std::is_same_v<T, bool>) {
    fits = value.is_boolean();
  } else if constexpr (std::is_integral_v<T>) {
    fits = value.is_number_unsigned()
               ? std::in_range<T>(value.get<std::uint64_t>())
               : value.is_number_integer() && std::in_range<T>(value.get<std::int64_t>());
  } else if constexpr (std::is_floating_point_v<T>) {
    fits = value.is_number() && std::isfinite(value.get<double>());
  } else if constexpr (std::is_same_v<T, std::string>) {
    fits = value.is_string();
  } else if constexpr (std::is_same_v<T, nlohmann::json::array_t>) {
    fits = value.is_array();
  }
  if (!fits) throw InputError(key + " = " + value.dump() + " has the wrong type or size");
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
