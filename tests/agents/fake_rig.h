#pragma once

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "agents/ports/camera_port.h"
#include "agents/ports/referee.h"
#include "agents/ports/robot_port.h"
#include "agents/ports/scene_port.h"
#include "tests/perception/synthetic_frame.h"

namespace gusset {

/// A rig without physics: the world is one of the six states, drawn flat; the arm goes wherever it
/// is sent and notes it. When the arm has left the view the world becomes `next`.
class FakeRig final : public ScenePort, public CameraPort, public RobotPort, public Referee {
 public:
  struct Move {
    enum Kind { kTo, kUntilContact, kFingers, kWaitingPose } kind;
    Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();
    double value = 0;  ///< Speed; a guarded move's force; opening of the fingers.
    double guarded_m_s = 0;
  };

  int state = 0;
  int next = 0;
  int unchanged_looks = 0;  ///< So often the arm leaves the view without the world becoming `next`.
  int refuse_at = -1;       ///< Index of the move (fingers not counted) that is refused ...
  MoveEnd refusal = MoveEnd::kUnreachable;
  bool corner_folded = false;        ///< In s2, with both layers ...
  bool corner_unfolds = false;       ///< ... until the arm has left the view.
  bool cube_between_fingers = true;  ///< Whatever it is: the pads do not meet ...
  double nothing_beyond_m = 1e9;     ///< ... unless they are so far from the table's middle.
  double cloth_between_fingers_m = 0.005;
  double weight_N = 1;  ///< Of what is held.
  double tilt_rad = 0;  ///< Of the tool where it is to point straight down, in the plane through
                        ///< the arm's base.
  double contact_height_m = -1;  ///< Guarded moves stop here, if they reach that far down.
  Truth truth;
  std::vector<Move> moves;
  std::uint64_t sensor_seed = 0;

  void Reset(StartKind kind, std::uint64_t) override {
    state = kind == StartKind::kFolded || kind == StartKind::kFoldedAnyPose ? 0 : 1;
  }
  Snapshot Save() override { return std::to_string(state); }
  void Restore(const Snapshot& snapshot, std::uint64_t seed) override {
    state = std::stoi(snapshot);
    sensor_seed = seed;
    moves.clear();
  }
  double time_s() const override { return time_s_; }

  const CameraModel& model() const override { return camera_; }
  RgbdFrame Look() override {
    using namespace synthetic;
    RgbdFrame frame = EmptyTable();
    if (state == 0) DrawFoldedBag(frame);
    if (state == 1) DrawFlatBag(frame);
    if (state == 2 && corner_folded) {
      DrawBagWithFoldedCorner(frame);
    } else if (state == 2 || state == 3) {
      DrawOpenBag(frame);
    }
    // In s3 in the mouth, off its middle; in s5 on the canvas; else where it waits.
    if (state == 3) DrawCube(frame, cube_in_mouth_px);
    if (state == 5) DrawCube(frame, {300, 250});
    if (state < 3) DrawCube(frame, cube_beside_px, 0.3);
    return frame;
  }
  cv::Point2d cube_in_mouth_px{320, 170};
  cv::Point2d cube_beside_px{562, 240};

  MoveResult MoveTo(const Eigen::Isometry3d& X_WT, double speed) override {
    const Eigen::Vector3d left(0.44 + X_WT.translation().y(), -X_WT.translation().x(), 0);
    Eigen::Isometry3d end = X_WT;
    if (X_WT.linear()(2, 2) < -0.999) {
      end.linear() = Eigen::AngleAxisd(tilt_rad, left.normalized()) * X_WT.linear();
    }
    return Note({Move::kTo, end, speed});
  }
  MoveResult MoveUntilContact(const Eigen::Isometry3d& X_WT, double speed,
                              double force_N) override {
    Eigen::Isometry3d end = X_WT;
    end.translation().z() = std::max(contact_height_m, X_WT.translation().z());
    MoveResult result = Note({Move::kUntilContact, end, force_N, speed});
    if (result.end == MoveEnd::kReached && contact_height_m > X_WT.translation().z()) {
      result.end = MoveEnd::kContact;
    }
    return result;
  }
  MoveResult MoveToWaitingPose() override {
    const auto left = std::ranges::count(moves, Move::kWaitingPose, &Move::kind);
    if (left >= unchanged_looks) state = next;
    if (corner_unfolds) corner_folded = false;
    return Note({Move::kWaitingPose, X_WT_, 0});
  }
  double MoveGripper(double opening_m, double, double) override {
    moves.push_back({Move::kFingers, X_WT_, opening_m});
    time_s_ += 0.5;
    const bool between =
        cube_between_fingers && X_WT_.translation().head<2>().norm() <= nothing_beyond_m;
    if (opening_m != 0 || !between) return opening_m;
    return state == 2 || IsAtCube() ? 0.035 : cloth_between_fingers_m;
  }
  void Wait(double seconds) override { time_s_ += seconds; }
  RobotReading Read() override { return {{}, {}, X_WT_, weight_N, 0}; }
  double max_opening_m() const override { return 0.085; }

  Truth Judge() override { return truth; }
  int LayersHeld() override { return truth.layers_held; }

 private:
  bool IsAtCube() const {
    const Eigen::Vector3d cube_W =
        camera_.OntoPlane(state == 3 ? cube_in_mouth_px : cube_beside_px, 0.035);
    return (X_WT_.translation() - cube_W).head<2>().norm() < 0.01;
  }
  MoveResult Note(const Move& move) {
    int index = 0;
    for (const Move& earlier : moves) index += earlier.kind != Move::kFingers;
    moves.push_back(move);
    if (index == refuse_at) return {refusal, X_WT_};
    X_WT_ = move.X_WT;
    time_s_ += 1;
    return {MoveEnd::kReached, X_WT_};
  }

  CameraModel camera_ = synthetic::Camera();
  Eigen::Isometry3d X_WT_ = Eigen::Isometry3d::Identity();
  double time_s_ = 0;
};

}  // namespace gusset
