#pragma once

#include <stdexcept>

namespace gusset {

/// What a user gave cannot be used: a config value, a file, an argument. what() is one line that
/// names file, line, key, value and bound as far as they apply. The program exits with 2.
class InputError : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// A run could not be finished: disk full, output not writable, the world stopped itself.
/// what() is one line. The program exits with 1.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace gusset
