// What no action of the arm may do to the cloth, watched while whole actions run.

#include <gtest/gtest.h>

#include <algorithm>

#include "agents/bagging_env.h"
#include "base/random.h"
#include "sim/cloth/self_contact.h"
#include "sim/sim_scene.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/sim_referee.h"

namespace gusset {
namespace {

// What counts as beside the grasp: two links from the fingers, which open to 85 mm.
constexpr float kBeside_m = 0.08f;

class ClothInActions : public ::testing::Test {
 protected:
  ClothInActions() {
    scene_.Watch(0.05, [this] { Look(); });
  }
  ~ClothInActions() override { scene_.Watch(0, {}); }

  void Look() {
    const ClothMesh& mesh = scene_.world().cloth().mesh();
    const Vec3Array& x = scene_.world().cloth().state().x;
    const Vec3f tip = scene_.robot().Read().X_WT.translation().cast<float>();
    for (const ClothLink& link : mesh.stretch) {
      const float ratio = (x[link.a] - x[link.b]).norm() / link.rest_m;
      const bool beside = (0.5f * (x[link.a] + x[link.b]) - tip).norm() < kBeside_m;
      float& most = beside ? most_beside_ : most_elsewhere_;
      most = std::max(most, ratio);
    }
    crossings_ += CountCrossings(mesh, x);
    ++looks_;
  }

  // A random action from `from`, which is in `state`.
  Outcome ActAtRandom(const Snapshot& from, int state, std::uint64_t seed) {
    EXPECT_EQ(env_.Begin(from, seed).state, state);
    Rng rng(DeriveSeed(seed, "cloth in actions"));
    return env_.Act(rng.Below(env_.ActionCounts()[static_cast<std::size_t>(state)]));
  }

  static SimConfig ReadSim(ConfigTree& tree) {
    SimConfig config;
    config.Read(tree);
    return config;
  }

  Settings settings_ = LoadSettings({}, {.bag = "bag1"});
  SimScene scene_{ReadSim(settings_.tree)};
  SimReferee referee_{scene_, settings_.bagging.perception, settings_.bagging.chosen_thresholds()};
  BaggingEnv env_{scene_, scene_, scene_.robot(), referee_, settings_.bagging};
  int crossings_ = 0, looks_ = 0;
  float most_beside_ = 0, most_elsewhere_ = 0;
};

TEST_F(ClothInActions, NeitherPassesThroughItselfNorOverstretches) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    (void)ActAtRandom(env_.Start(StartKind::kFolded, seed), 0, seed);
  }
  const Snapshot flat = env_.Start(StartKind::kUnfolded, 1);
  for (std::uint64_t seed = 1; seed <= 6; ++seed) (void)ActAtRandom(flat, 1, seed);
  EXPECT_GT(looks_, 9 * 100);
  EXPECT_EQ(crossings_, 0);
  EXPECT_LT(most_elsewhere_, 1.1f);
  EXPECT_LT(most_beside_, 1.2f);
}

}  // namespace
}  // namespace gusset
