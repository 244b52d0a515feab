// What libFuzzer drives (tests/fuzz/perception_fuzz.cc) on the bytes of many
// seeds, with every
// build: that it compiles, and that no change breaks what takes a fuzzer no time to find.

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "base/random.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace gusset {
namespace {

TEST(PerceptionFuzz, AnswersOrThrowsInputErrorWhateverItIsGiven) {
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(DeriveSeed(seed, "fuzz"));
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(rng.Below(700)));
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(rng.Below(256));
    EXPECT_NO_THROW(LLVMFuzzerTestOneInput(bytes.data(), bytes.size()));
  }
}

}  // namespace
}  // namespace gusset
