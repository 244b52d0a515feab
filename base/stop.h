#pragma once

#include <stdexcept>

namespace gusset {

/// Thrown from the midst of an action once a stop was requested: what is under way is given up, and
/// what was finished before is kept. Neither an InputError nor a RunError, for nothing is wrong.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// From now on StopRequested() is true, on all threads. Safe in a signal handler.
void RequestStop();
bool StopRequested();
/// Takes it back, for tests.
void ForgetStop();

/// To be called every now and then by what may take long. @throws Interrupted.
inline void ThrowIfStopped() {
  if (StopRequested()) throw Interrupted();
}

}  // namespace gusset
