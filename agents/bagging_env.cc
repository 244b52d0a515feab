#include "agents/bagging_env.h"

#include <cstdio>

#include "agents/json_fields.h"
#include "agents/look_files.h"
#include "agents/rewards.h"
#include "base/error.h"
#include "base/files.h"
#include "perception/view.h"

namespace gusset {
namespace {

// Success as design and tests define it: clear of the table with the cube inside for the last
// second.
constexpr double kHeldClear_s = 1.0;

struct Sections {
  ConfigTree& tree;
  template <class Config>
  void operator()(const char* name, Config& config) {
    tree.Read(name, config);
  }
};

struct Writers {
  std::string& out;
  template <class Config>
  void operator()(const char* name, const Config& config) {
    AppendToml(name, config, out);
  }
};

template <class Config, class Visitor>
void VisitSections(Config& config, Visitor visit) {
  visit("perception", config.perception);
  visit("thresholds", config.thresholds);
  visit("primitives", config.motion);
  visit("primitives.grasp_lift", config.grasp_lift);
  visit("primitives.scratch_drag", config.scratch_drag);
  visit("primitives.pick_place", config.pick_place);
  visit("primitives.close_carry", config.close_carry);
}

nlohmann::ordered_json Pair(const cv::Point2d& p) { return {p.x, p.y}; }
nlohmann::ordered_json Triple(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

// The pose point that an action's point index means (grasp point, or place point in s2).
const PosePoint& ChosenPoint(const Observation& seen, int point) {
  const auto& points = seen.state == State::kOpen ? seen.place_points : seen.grasp_points;
  return points.at(static_cast<std::size_t>(point));
}

Eigen::Vector3d AlongRim(const Observation& seen) {
  return seen.rim ? seen.rim->along_W : Eigen::Vector3d::UnitX();
}

std::optional<Mouth> MouthOf(const Observation& seen, const CameraModel& camera,
                             double table_height_m) {
  if (!seen.lips || !seen.rim) return std::nullopt;
  Mouth mouth{seen.lips->near.p_W, seen.lips->drawn.p_W, seen.rim->outward_W};
  if (seen.width) {
    const auto at = [&](double x) {
      return camera.OntoPlane(seen.opening_centre.px + cv::Point2d(x, 0), table_height_m);
    };
    const double m_per_px = (at(1) - at(0)).norm();
    mouth.width = {seen.width->radius_px * m_per_px,
                   seen.width->length_px * m_per_px,
                   {seen.width->sides[0].p_W, seen.width->sides[1].p_W},
                   seen.width->closed};
  }
  return mouth;
}

// Refuses a value for what another one is. @param than as "not below thresholds.A_flat".
void RefuseBeside(const ConfigTree& tree, const std::string& key, double value,
                  const std::string& than, double other) {
  char number[32];
  std::snprintf(number, sizeof number, "%g", other);
  tree.Refuse(key, value, "is " + than + " = " + number);
}

// A bag that never counts as unfolded, or whose best opening is none.
void CheckThresholds(const ConfigTree& tree, const std::string& section, const BagThresholds& t) {
  const auto below = [&](const char* key, double value, const char* other, double bound) {
    if (value < bound) return;
    RefuseBeside(tree, section + "." + key, value, "not below " + section + "." + other, bound);
  };
  below("A_th", t.A_th, "A_flat", t.A_flat);
  below("A_th", t.A_th, "A_bmax", t.A_bmax);
  below("A_oth", t.A_oth, "A_omax", t.A_omax);
}

// Two ends of a range; the one that is given is refused if they are the wrong way round.
void CheckOrder(const ConfigTree& tree, const std::string& section, const std::string& least,
                double least_value, const std::string& most, double most_value) {
  if (least_value <= most_value) return;
  if (tree.Has(section + "." + least))
    RefuseBeside(tree, section + "." + least, least_value, "above " + most, most_value);
  RefuseBeside(tree, section + "." + most, most_value, "below " + least, least_value);
}

// Hues end at 179 and may wrap; a saturation or brightness that does finds nothing.
void CheckColours(const ConfigTree& tree, const std::string& what, const std::vector<double>& min,
                  const std::vector<double>& max) {
  const std::string key = "perception." + what + "_hsv_";
  for (const auto& [end, hsv] : {std::pair("min", &min), std::pair("max", &max)}) {
    if (hsv->at(0) > 179) tree.Refuse(key + end, hsv->at(0), "is no hue within [0, 179]");
  }
  for (std::size_t k = 1; k < 3; ++k) {
    if (min[k] <= max[k]) continue;
    RefuseBeside(tree, key + "min", min[k], "above " + what + "_hsv_max's", max[k]);
  }
}

// MakeView refuses such a region too, but knows only the image.
void CheckRegion(const ConfigTree& tree, const PerceptionConfig& perception) {
  const auto within = [&](const char* key, int from, int size) {
    if (from + perception.roi_side <= size) return;
    RefuseBeside(tree, std::string("perception.") + key, from,
                 "more than the frame's " + std::to_string(size) + " less perception.roi_side",
                 perception.roi_side);
  };
  within("roi_x", perception.roi_x, kFrameWidth);
  within("roi_y", perception.roi_y, kFrameHeight);
}

}  // namespace

void BaggingConfig::Read(ConfigTree& tree) {
  VisitSections(*this, Sections{tree});
  CheckOrder(tree, "perception", "hem_min_px", perception.hem_min_px, "hem_max_px",
             perception.hem_max_px);
  CheckOrder(tree, "perception", "depth_min_m", perception.depth_min_m, "depth_max_m",
             perception.depth_max_m);
  CheckOrder(tree, "perception", "cube_min_px2", perception.cube_min_px2, "cube_max_px2",
             perception.cube_max_px2);
  CheckOrder(tree, "perception", "bag_min_px2", perception.bag_min_px2, "bag_max_px2",
             perception.bag_max_px2);
  CheckColours(tree, "bag", perception.bag_hsv_min, perception.bag_hsv_max);
  CheckColours(tree, "label", perception.label_hsv_min, perception.label_hsv_max);
  CheckColours(tree, "cube", perception.cube_hsv_min, perception.cube_hsv_max);
  if (perception.depth_window_px % 2 == 0) {
    tree.Refuse("perception.depth_window_px", perception.depth_window_px, "is not odd");
  }
  CheckRegion(tree, perception);
  CheckThresholds(tree, "thresholds", thresholds.gusset);
  if (tree.Has("thresholds_published")) {
    published.emplace();
    tree.Read("thresholds_published", *published);
    CheckThresholds(tree, "thresholds_published", *published);
  } else if (thresholds.source == "published") {
    throw InputError("thresholds.source = \"published\" needs a section [thresholds_published]");
  }
}

void BaggingConfig::AppendTo(std::string& out) const {
  VisitSections(*this, Writers{out});
  if (published) AppendToml("thresholds_published", *published, out);
}

BaggingEnv::BaggingEnv(ScenePort& scene, CameraPort& camera, RobotPort& robot, Referee& referee,
                       const BaggingConfig& config)
    : scene_(scene),
      camera_(camera),
      referee_(referee),
      robot_(robot, referee),
      config_(config),
      thresholds_(config.chosen_thresholds()) {}

std::vector<int> BaggingEnv::ActionCounts() const { return ActionsOnOffer(config_.affordances); }

Percept BaggingEnv::PerceptOf(const Observation& seen) const {
  return {static_cast<int>(seen.state),
          {seen.A_bag / thresholds_.A_bmax, seen.A_o / thresholds_.A_omax,
           seen.mouth_seen ? 1.0 : 0.0, seen.cube ? 1.0 : 0.0}};
}

Snapshot BaggingEnv::Start(StartKind kind, std::uint64_t seed) {
  scene_.Reset(kind, seed);
  return scene_.Save();
}

Percept BaggingEnv::Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) {
  scene_.Restore(snapshot, sensor_seed);
  if (!config_.affordances) world_before_ = snapshot;
  frame_before_ = camera_.Look();
  before_ = Perceive(frame_before_, camera_.model(), config_.perception, thresholds_);
  frame_after_ = {};
  return PerceptOf(before_);
}

Observation BaggingEnv::LookBetween(ToolMotion& tool) {
  tool.LeaveTheView();
  return Perceive(camera_.Look(), camera_.model(), config_.perception, thresholds_);
}

bool BaggingEnv::LooksUnfolded(ToolMotion& tool) {
  const Observation seen = LookBetween(tool);
  switch (seen.state) {
    case State::kFolded:
      return false;
    case State::kUnfolded:
      return seen.A_bag >= config_.grasp_lift.flat_share * thresholds_.A_flat;
    case State::kOpen:
      // Folded so that both lips show, a bag has a mouth that it would have to be rid of first.
      return TakesTheCube(MouthIn(seen), config_.pick_place);
    default:
      return true;  // it lies on the cube or is gone: not for this pair to mend
  }
}

std::optional<Mouth> BaggingEnv::MouthIn(const Observation& seen) const {
  return MouthOf(seen, camera_.model(), config_.perception.table_height_m);
}

bool BaggingEnv::ClearTheWay(ToolMotion& tool, const Observation& seen) {
  if (!seen.cube || !seen.cube->in_roi || seen.cube->on_bag) return false;
  return SetAside(tool, seen.cube->p_W, seen.cube->yaw_rad, OnTable(seen.bag_centroid),
                  config_.pick_place, config_.motion);
}

void BaggingEnv::PlaceOrMend(ToolMotion& tool, int point, const Unfold& unfold) {
  const PickPlaceConfig& config = config_.pick_place;
  for (int mended = 0;;) {
    if (!acted_on_.cube) throw ToolMotion::Aborted("pick: no cube in sight");
    const std::optional<Mouth> mouth = MouthIn(acted_on_);
    if (TakesTheCube(mouth, config)) {
      PickPlace(tool, acted_on_.cube->p_W, acted_on_.cube->yaw_rad,
                ChosenPoint(acted_on_, point).p_W, mouth, config, config_.motion);
      if (mended > 0) tool.Note("then placed");
      return;
    }
    ClearTheWay(tool, acted_on_);
    MendMouth(tool, *mouth, config, unfold, config_.scratch_drag, config_.motion);
    // The look after the last is the action's own.
    if (++mended >= config.mends) return;
    Observation seen = LookBetween(tool);
    if (seen.state != State::kOpen) return;
    acted_on_ = std::move(seen);
  }
}

void BaggingEnv::CloseAndCarry(ToolMotion& tool, int point) {
  const CloseCarryConfig& config = config_.close_carry;
  Eigen::Vector3d cube_W = OnTable(before_.bag_centroid);
  for (int dropped = 0;; ++dropped) {
    // By the mouth, but not in it: this bag is not to be carried.
    if (ClearTheWay(tool, acted_on_)) return;
    if (acted_on_.cube) cube_W = acted_on_.cube->p_W;
    const Eigen::Vector3d p_W = ChosenPoint(acted_on_, point).p_W;
    const Eigen::Vector3d along_W = AlongRim(acted_on_);
    const std::optional<Mouth> mouth = MouthIn(acted_on_);
    if (dropped >= config.lip_drops || !LipFalls(mouth, config)) {
      return CloseCarry(tool, p_W, along_W, mouth, cube_W, config, config_.scratch_drag,
                        config_.grasp_lift, config_.motion);
    }
    DropLip(tool, p_W, along_W, *mouth, cube_W, config, config_.scratch_drag, config_.grasp_lift,
            config_.motion);
    Observation seen = LookBetween(tool);
    if (seen.state != State::kFilled) return;
    acted_on_ = std::move(seen);
  }
}

std::string BaggingEnv::Perform(int point, int parameter) {
  const MotionConfig& motion = config_.motion;
  acted_on_ = before_;
  return PerformAndLeave(robot_, motion, [&](ToolMotion& tool) {
    const Unfold unfold = [&](const Eigen::Vector3d& from_W, const Eigen::Vector3d& centre_W,
                              int height) {
      GraspLift(tool, from_W, centre_W, height, config_.grasp_lift, motion,
                [&] { return LooksUnfolded(tool); });
    };
    switch (before_.state) {
      case State::kFolded:
        ClearTheWay(tool, before_);
        return unfold(before_.edge_points.at(static_cast<std::size_t>(point)).p_W,
                      OnTable(before_.bag_centroid), parameter);
      case State::kUnfolded:
        ClearTheWay(tool, before_);
        return ScratchDrag(tool, ChosenPoint(before_, point).p_W,
                           before_.place_points.at(static_cast<std::size_t>(parameter)).p_W,
                           AlongRim(before_), config_.scratch_drag, motion);
      case State::kOpen:
        return PlaceOrMend(tool, point, unfold);
      case State::kFilled:
        return CloseAndCarry(tool, point);
      default:
        throw std::logic_error("no action is afforded in s4 and s5");
    }
  });
}

// What a pair that does not fit the state leads to: a step without a move, a look or time. The
// reward is the state's own for a world in which nothing has changed, which is what a fitting
// action that achieves nothing is paid too.
Outcome BaggingEnv::Idle(int pair, const ActionChoice& choice) {
  after_ = before_;
  frame_after_ = frame_before_;
  truth_before_ = truth_after_ = referee_.Judge();
  Outcome outcome;
  outcome.next = PerceptOf(after_);
  outcome.reward = Reward(before_, after_, thresholds_, {});
  outcome.truth = truth_after_;
  outcome.after = world_before_;
  outcome.log = {{"pair", pair},
                 {"point", choice.point},
                 {"parameter", choice.parameter},
                 {"layers_held", 0},
                 {"lost", false},
                 {"A_bag_before", before_.A_bag},
                 {"A_o_before", before_.A_o},
                 {"A_bag", after_.A_bag},
                 {"A_o", after_.A_o},
                 {"cube_hidden", after_.cube_hidden},
                 {"note", "the pair does not fit the state"}};
  return outcome;
}

Outcome BaggingEnv::Act(int action) {
  const int state = static_cast<int>(before_.state);
  if (!config_.affordances) {
    const int pair = PairOfAction(action, action);
    if (pair != state) return Idle(pair, DecodeAction(pair, action));
  }
  const ActionChoice choice = DecodeAction(state, action);
  const double start_s = scene_.time_s();

  truth_before_ = referee_.Judge();
  robot_.Forget();
  const std::string note = Perform(choice.point, choice.parameter);
  frame_after_ = camera_.Look();
  after_ = Perceive(frame_after_, camera_.model(), config_.perception, thresholds_);

  Outcome outcome;
  outcome.next = PerceptOf(after_);
  const PosePoint& chosen = ChosenPoint(acted_on_, choice.point);
  outcome.reward = Reward(acted_on_, after_, thresholds_, chosen.px);
  // s4 and s5 count only after close + carry; a bag that left the ROI otherwise is lost.
  outcome.done = after_.state == State::kSuccess || after_.state == State::kFail;
  const bool carried = before_.state == State::kFilled;
  outcome.success = carried && after_.state == State::kSuccess;
  outcome.truth = truth_after_ = referee_.Judge();
  outcome.true_success = carried && outcome.truth.held_clear_s >= kHeldClear_s;
  outcome.after = scene_.Save();
  outcome.sim_s = scene_.time_s() - start_s;
  outcome.log = {{"pair", state},
                 {"point", choice.point},
                 {"parameter", choice.parameter},
                 {"point_px", Pair(chosen.px)},
                 {"point_m", Triple(chosen.p_W)},
                 {"layers_held", robot_.layers_held()},
                 {"lost", outcome.done && !carried},
                 {"A_bag_before", before_.A_bag},
                 {"A_o_before", before_.A_o},
                 {"A_bag", after_.A_bag},
                 {"A_o", after_.A_o},
                 {"cube_hidden", after_.cube_hidden},
                 {"note", note}};
  return outcome;
}

FrameWriter BaggingEnv::Frames() const {
  const Look before{frame_before_, before_, truth_before_};
  const Look after{frame_after_, after_, truth_after_};
  return [before, after, camera = camera_.model(), config = config_.perception](
             const std::filesystem::path& prefix, const nlohmann::ordered_json& about) {
    nlohmann::ordered_json document = about;
    document["before"] = WriteLook(prefix.string() + "_before", before, camera, config);
    document["after"] = WriteLook(prefix.string() + "_after", after, camera, config);
    // Last: what a JSON file tells of is there.
    WriteFileAtomic(prefix.string() + ".json", JsonText(document));
  };
}

}  // namespace gusset
