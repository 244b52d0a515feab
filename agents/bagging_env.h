#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "agents/affordances.h"
#include "agents/environment.h"
#include "agents/ports/camera_port.h"
#include "agents/ports/referee.h"
#include "agents/ports/robot_port.h"
#include "agents/ports/scene_port.h"
#include "agents/primitives/close_carry.h"
#include "agents/primitives/grasp_lift.h"
#include "agents/primitives/pick_place.h"
#include "agents/primitives/scratch_drag.h"
#include "agents/witness.h"
#include "perception/perceive.h"

namespace gusset {

/// Section [thresholds]: a bag's thresholds and which of its two sets counts.
struct ThresholdChoice {
  std::string source = "gusset";  ///< "published": Table 5.3 to the letter.
  BagThresholds gusset;

  template <class V>
  void Fields(V& v) {
    v("source", source, std::vector<std::string>{"gusset", "published"});
    gusset.Fields(v);
  }
};

/// Everything the bagging task can be set to, but for bag and world.
struct BaggingConfig {
  PerceptionConfig perception;
  ThresholdChoice thresholds;
  std::optional<BagThresholds> published;  ///< Section [thresholds_published].
  MotionConfig motion;
  GraspLiftConfig grasp_lift;
  ScratchDragConfig scratch_drag;
  PickPlaceConfig pick_place;
  CloseCarryConfig close_carry;
  /// False: every state offers the actions of all four pairs, and one whose pair does not fit the
  /// state costs a step, moves nothing and is paid as an action that achieves nothing. Set by
  /// [train].
  bool affordances = true;

  /// Reads every section. @throws InputError.
  void Read(ConfigTree& tree);
  /// The set of thresholds that counts.
  const BagThresholds& chosen_thresholds() const {
    return thresholds.source == "published" ? *published : thresholds.gusset;
  }
  /// Appends every section to `out`.
  void AppendTo(std::string& out) const;
};

/// Bagging: Algorithm 8's "perform a". Looks, runs the pair of primitives that the state affords,
/// leaves the view, looks again, pays the reward. The agent's side sees frames and the arm's own
/// readings only; the referee is asked for the log and for evaluation.
class BaggingEnv final : public Environment {
 public:
  /// The ports must outlive the environment.
  BaggingEnv(ScenePort& scene, CameraPort& camera, RobotPort& robot, Referee& referee,
             const BaggingConfig& config);

  std::vector<int> ActionCounts() const override;
  Snapshot Start(StartKind kind, std::uint64_t seed) override;
  Percept Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) override;
  Outcome Act(int action) override;
  /// PREFIX_before and PREFIX_after, each as .png, _depth.png (16 bit, mm), _overlay.png and
  /// _masks.png, and last PREFIX.json with what perception made of both looks and the truth.
  FrameWriter Frames() const override;

  const RgbdFrame& frame_before() const { return frame_before_; }
  const Observation& before() const { return before_; }
  const Observation& after() const { return after_; }

 private:
  Percept PerceptOf(const Observation& observation) const;
  std::string Perform(int point, int parameter);
  /// In s2: places the cube, once the mouth has been mended if it needs to be.
  void PlaceOrMend(ToolMotion& tool, int point, const Unfold& unfold);
  /// In s3: carries the bag, its lip laid over first where that is to fall, or puts away a cube
  /// that is seen beside it.
  void CloseAndCarry(ToolMotion& tool, int point);
  /// A cube on the table beside the bag would be under it as soon as the bag is moved.
  /// @returns whether there was one and it is away now.
  bool ClearTheWay(ToolMotion& tool, const Observation& seen);
  /// In the middle of an action: leaves the view, lets things settle, looks.
  Observation LookBetween(ToolMotion& tool);
  /// Such a look. False while pulls may help: in s0, in s1 with less than
  /// GraspLiftConfig::flat_share of the bag in sight, in s2 with a mouth in which the cube would
  /// not be placed.
  bool LooksUnfolded(ToolMotion& tool);
  Outcome Idle(int pair, const ActionChoice& choice);
  std::optional<Mouth> MouthIn(const Observation& seen) const;
  Eigen::Vector3d OnTable(const cv::Point2d& px) const {
    return camera_.model().OntoPlane(px, config_.perception.table_height_m);
  }

  ScenePort& scene_;
  CameraPort& camera_;
  Referee& referee_;
  Witness robot_;
  BaggingConfig config_;
  BagThresholds thresholds_;
  Snapshot world_before_;
  RgbdFrame frame_before_, frame_after_;
  Observation before_, after_;
  Observation acted_on_;  ///< What the action went by at last: before_, or a look in its middle.
  Truth truth_before_, truth_after_;
};

}  // namespace gusset
