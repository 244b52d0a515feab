#pragma once

#include <memory>
#include <utility>

#include "agents/bagging_env.h"
#include "agents/image_file.h"
#include "tools/gusset/wiring.h"

namespace gusset {

/// The bagging environment together with the testbed it runs on.
class TestbedEnv final : public Environment {
 public:
  TestbedEnv(std::unique_ptr<Testbed> testbed, const BaggingConfig& config)
      : testbed_(std::move(testbed)),
        env_(testbed_->scene(), testbed_->camera(), testbed_->robot(), testbed_->referee(),
             config) {}

  std::vector<int> ActionCounts() const override { return env_.ActionCounts(); }
  Snapshot Start(StartKind kind, std::uint64_t seed) override { return env_.Start(kind, seed); }
  Percept Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) override {
    return env_.Begin(snapshot, sensor_seed);
  }
  Outcome Act(int action) override { return env_.Act(action); }
  FrameWriter Frames() const override {
    if (!from_the_side_) return env_.Frames();
    return [frames = env_.Frames(), side = testbed_->ObliqueLook().color](
               const std::filesystem::path& prefix, const nlohmann::ordered_json& about) {
      WriteImage(prefix.string() + "_oblique.png", side);
      frames(prefix, about);
    };
  }
  /// From now on Frames holds PREFIX_oblique.png too, the scene from the side.
  void ShowFromTheSide() { from_the_side_ = true; }

  Testbed& testbed() { return *testbed_; }
  BaggingEnv& bagging() { return env_; }

 private:
  std::unique_ptr<Testbed> testbed_;
  BaggingEnv env_;
  bool from_the_side_ = false;
};

}  // namespace gusset
