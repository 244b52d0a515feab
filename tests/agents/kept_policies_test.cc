#include <gtest/gtest.h>

#include "agents/affordances.h"
#include "agents/pi_learning.h"
#include "agents/run_folder.h"

namespace gusset {
namespace {

// A policy that comes along must stay one that can be loaded, whatever its format becomes.
class KeptPolicy : public ::testing::TestWithParam<const char*> {};

TEST_P(KeptPolicy, KnowsAnActionOfEveryState) {
  const std::vector<int> n_actions = ActionsOnOffer(true);
  PiLearning agent(PiConfig(), n_actions);
  LoadPolicy(std::filesystem::path(GUSSET_SOURCE_DIR) / "assets/policies" / GetParam(), agent);
  const nlohmann::json states = agent.Save().at("states");
  ASSERT_EQ(states.size(), n_actions.size());
  for (std::size_t s = 0; s < states.size(); ++s) {
    EXPECT_EQ(states[s].at("steps"), 100);
    EXPECT_GT(states[s].at("best_value"), 0) << "an action never tried is worth 0";
  }
}

INSTANTIATE_TEST_SUITE_P(Files, KeptPolicy,
                         ::testing::Values("pi100-seed1.json", "pi100-seed2.json"));

}  // namespace
}  // namespace gusset
