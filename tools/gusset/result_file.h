#pragma once

#include <string>

namespace gusset {

/// For before long work whose JSON document will be written to `file`.
/// @param key  one that every such document has.
/// @throws InputError if no file can be put there, or if one is there that is no earlier document
/// of this kind: what is measured is not to take the place of what it is measured on.
void CheckResultFile(const std::string& file, const std::string& key);

}  // namespace gusset
