#include "tools/gusset/corpus_score.h"

#include <gtest/gtest.h>

#include "sim/top_view.h"

namespace gusset {
namespace {

LabelledFrame Frame(State state, double A_bag, double A_o, int labels) {
  LabelledFrame frame;
  frame.state = state;
  frame.has_areas = true;
  frame.A_bag = A_bag;
  frame.A_o = A_o;
  frame.labels = labels;
  return frame;
}

constexpr double kFloor_px2 = 10;

Observation Seen(State state, double A_bag = 30000, double A_o = 0) {
  Observation seen;
  seen.state = state;
  seen.bag_seen = true;
  seen.mouth_seen = true;
  seen.A_bag = A_bag;
  seen.A_o = A_o;
  return seen;
}

// Bag 1: A_th = 25000, A_oth = 700, 0.55 A_flat = 19222.5.
TEST(ThresholdMargin, IsTheLeastChangeOfAreaThatChangesTheState) {
  const BagThresholds bag1;
  const auto margin = [&](const LabelledFrame& frame) {
    return ThresholdMargin(frame, bag1, kFloor_px2);
  };
  EXPECT_FALSE(margin(Frame(State::kUnfolded, 34000, 0, 5)));
  EXPECT_NEAR(margin(Frame(State::kUnfolded, 25500, 0, 5)).value(), 500 / 25500.0, 1e-6);
  EXPECT_NEAR(margin(Frame(State::kFolded, 24500, 0, 5)).value(), 500 / 24500.0, 1e-6);
  EXPECT_NEAR(margin(Frame(State::kUnfolded, 34000, 690, 5)).value(), 10 / 690.0, 1e-6);
  EXPECT_NEAR(margin(Frame(State::kOpen, 34000, 710, 5)).value(), 10 / 710.0, 1e-6);
  EXPECT_NEAR(margin(Frame(State::kOpen, 19400, 2000, 5)).value(), 177.5 / 19400, 1e-6);
  // Both must change: from s0, just below 0.55 A_flat and A_oth, to s2.
  EXPECT_NEAR(margin(Frame(State::kFolded, 19000, 690, 5)).value(), 10 / 690.0, 1e-3);
}

TEST(ThresholdMargin, CountsOnlyThresholdsThatDecide) {
  const BagThresholds bag1;
  EXPECT_FALSE(ThresholdMargin(Frame(State::kFolded, 25100, 0, 2), bag1, kFloor_px2))
      << "no mouth: s0 anyhow";
  EXPECT_FALSE(ThresholdMargin(Frame(State::kFolded, 19300, 0, 5), bag1, kFloor_px2))
      << "0.55 is for s2";
  EXPECT_FALSE(ThresholdMargin(Frame(State::kOpen, 25100, 3000, 5), bag1, kFloor_px2))
      << "s2 on either side";
  EXPECT_FALSE(ThresholdMargin(Frame(State::kFilled, 25100, 700, 5), bag1, kFloor_px2));
}

// Three labels 90 px apart make a mouth of several thousand px^2, two make none. The fourth lies
// among them and hardly changes it.
TEST(ThresholdMargin, TakesInTheNoiseFloorOfLabelsThatDecide) {
  const BagThresholds bag1;
  LabelledFrame frame = Frame(State::kOpen, 34000, 4000, 3);
  const auto margin = [&](double third_px2, double fourth_px2) {
    frame.shown = {
        {55, {100, 100}}, {55, {190, 100}}, {third_px2, {145, 190}}, {fourth_px2, {140, 130}}};
    return ThresholdMargin(frame, bag1, kFloor_px2);
  };
  EXPECT_FALSE(margin(30, 5));
  EXPECT_NEAR(margin(10.2, 5).value(), 0.2 / 10.2, 1e-6) << "two labels less: no mouth";
  EXPECT_FALSE(margin(10.4, 5)) << "further off than 3 %";
  frame = Frame(State::kOpen, 34000, 4000, 4);
  EXPECT_FALSE(margin(30, 10.2)) << "s2 without it, too";
  // From two labels and s0 to three.
  frame = Frame(State::kFolded, 34000, 0, 2);
  EXPECT_NEAR(margin(9.9, 5).value(), 0.1 / 9.9, 1e-6);
}

TEST(CorpusScore, CountsClearFramesAndNearOnesApart) {
  const BagThresholds bag1;
  CorpusScore score;
  const LabelledFrame flat = Frame(State::kUnfolded, 34000, 0, 5);
  EXPECT_TRUE(score.Add(flat, bag1, std::nullopt, Seen(State::kUnfolded), {}));
  EXPECT_FALSE(score.Add(flat, bag1, std::nullopt, Seen(State::kOpen), {}));
  EXPECT_FALSE(
      score.Add(Frame(State::kUnfolded, 25100, 0, 5), bag1, 0.004, Seen(State::kFolded), {}));
  const nlohmann::ordered_json report = score.Report();
  EXPECT_EQ(report.at("frames"), 3);
  EXPECT_EQ(report.at("clear_frames"), 2);
  EXPECT_EQ(report.at("accuracy"), 0.5);
  EXPECT_EQ(report.at("confusion").at(1).at(1), 1);
  EXPECT_EQ(report.at("confusion").at(1).at(2), 1);
  EXPECT_EQ(report.at("near_thresholds").at(0).at("frames"), 1);
  EXPECT_EQ(report.at("near_thresholds").at(0).at("right"), 0);
  EXPECT_FALSE(score.Text().empty());
}

TEST(CorpusScore, BiasAndSpreadAreMeanAndStandardDeviation) {
  const BagThresholds bag1;
  CorpusScore score;
  for (const double A_bag : {33000, 35000}) {
    score.Add(Frame(State::kUnfolded, 32000, 0, 5), bag1, std::nullopt,
              Seen(State::kUnfolded, A_bag, 10), {});
  }
  const nlohmann::ordered_json state = score.Report().at("states").at(1);
  EXPECT_NEAR(state.at("A_bag_px2").at("bias").get<double>(), 2000, 1e-9);
  EXPECT_NEAR(state.at("A_bag_px2").at("spread").get<double>(), std::sqrt(2.0) * 1000, 1e-6);
  EXPECT_NEAR(state.at("A_o_px2").at("bias").get<double>(), 10, 1e-9);
}

TEST(CorpusScore, PosePointsCountWhereTheyAreMeantToBe) {
  cv::Mat surface(480, 640, CV_8UC3, cv::Scalar(0, 0, 0));
  surface(cv::Rect(100, 100, 100, 100)).setTo(cv::Scalar(static_cast<int>(Shown::kOuter1), 5, 0));
  surface(cv::Rect(200, 100, 100, 100)).setTo(cv::Scalar(static_cast<int>(Shown::kInner0), 90, 0));
  Observation seen = Seen(State::kUnfolded);
  // At the rim; on cloth 0.18 m from it; beside the bag; beside the image.
  for (const cv::Point2d& px : {cv::Point2d(150, 150), {250, 150}, {50, 50}, {-5, 700}}) {
    seen.grasp_points.push_back({px, Eigen::Vector3d::Zero(), true});
    seen.place_points.push_back({px, Eigen::Vector3d::Zero(), true});
  }
  CorpusScore score;
  score.Add(Frame(State::kUnfolded, 34000, 0, 5), BagThresholds(), std::nullopt, seen, surface);
  seen.state = State::kOpen;
  // Once too narrow for the cube, once of unknown width, once as wide as it has to be; and a lip
  // with as much room that is no closed mouth.
  const double room = PerceptionConfig().place_inset_px;
  for (const double radius : {0.9 * room, 0.0, room}) {
    seen.width.reset();
    if (radius > 0) seen.width = Width{radius, 100, {}};
    score.Add(Frame(State::kOpen, 34000, 2000, 5), BagThresholds(), std::nullopt, seen, surface);
  }
  seen.width->closed = false;
  score.Add(Frame(State::kOpen, 34000, 2000, 5), BagThresholds(), std::nullopt, seen, surface);
  const nlohmann::ordered_json points = score.Report().at("pose_points");
  EXPECT_EQ(points.at(2).at("share"), 0.25) << points.at(2).dump();
  EXPECT_EQ(points.at(3).at("share"), 0.5) << points.at(3).dump();
  EXPECT_EQ(points.at(4).at("share"), 0.25) << points.at(4).dump();
  EXPECT_EQ(points.at(4).at("count"), 16) << points.at(4).dump();
  EXPECT_EQ(points.at(5).at("share"), 0.25) << points.at(5).dump();
  EXPECT_EQ(points.at(5).at("count"), 4) << points.at(5).dump();
}

}  // namespace
}  // namespace gusset
