#include "base/stop.h"

#include <atomic>

namespace gusset {
namespace {

std::atomic<bool> stop_requested = false;
static_assert(std::atomic<bool>::is_always_lock_free);

}  // namespace

void RequestStop() { stop_requested.store(true, std::memory_order_relaxed); }
bool StopRequested() { return stop_requested.load(std::memory_order_relaxed); }
void ForgetStop() { stop_requested.store(false, std::memory_order_relaxed); }

}  // namespace gusset
