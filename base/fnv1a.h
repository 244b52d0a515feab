#pragma once

#include <cstdint>
#include <string_view>

namespace gusset {

/// FNV-1a of 64 bits (Fowler, Noll, Vo): tells changed bytes, against no one who means it.
inline std::uint64_t Fnv1a(std::string_view bytes) {
  std::uint64_t h = 0xcbf29ce484222325ull;
  for (const char c : bytes) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return h;
}

}  // namespace gusset
