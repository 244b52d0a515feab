#include "sim/robot/robot_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "base/error.h"
#include "sim/robot/mesh_file.h"
#include "tests/sim/robot_fixture.h"

namespace gusset {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class RobotFiles : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  std::string LoadError(const std::string& urdf) const {
    try {
      (void)RobotModel::Load(Write("r.urdf", urdf));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("gusset_robot_model_" + std::to_string(getpid()));
};

// Two revolute joints, 1 m and 0.5 m, turning about y; the tip hangs 0.5 m further.
const std::string kTwoJoints = R"(<robot name="two">
  <link name="base"/>
  <link name="a"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
  <link name="b"/>
  <link name="tip"/>
  <joint name="j1" type="revolute"><parent link="base"/><child link="a"/>
    <axis xyz="0 2 0"/><limit lower="-2" upper="2" velocity="1" effort="100"/></joint>
  <joint name="j2" type="continuous"><parent link="a"/><child link="b"/><origin xyz="1 0 0"/>
    <axis xyz="0 1 0"/><limit velocity="1" effort="50"/></joint>
  <joint name="j3" type="fixed"><parent link="b"/><child link="tip"/><origin xyz="0.5 0 0"/></joint>
</robot>)";

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

RobotConfig TwoJointConfig() {
  RobotConfig config;
  config.urdf = "r.urdf";
  config.joint_limits = "limits.toml";
  config.base_link = "base";
  config.tip_link = "tip";
  config.finger_joint_a = config.finger_joint_b = "";
  config.base_m = {0, 0, 0};
  config.base_yaw_deg = 0;
  config.waiting_deg = config.gate_deg = config.posture_deg = config.posture_weight = {0, 0};
  return config;
}

TEST_F(RobotFiles, AnyUrdfLoadsWithoutSpecialNames) {
  Write("r.urdf", kTwoJoints);
  Write("limits.toml", "acceleration_rad_s2 = [1, 2]\n");
  const ArmModel arm = ArmModel::Load(TwoJointConfig(), folder_);
  ASSERT_EQ(arm.num_joints(), 2);
  EXPECT_FALSE(arm.has_gripper());
  JointVector q(2);
  q << 90 * kDegree, -90 * kDegree;
  // The first arm points down, the second forwards again.
  EXPECT_TRUE(arm.ToolPose(q).translation().isApprox(Eigen::Vector3d(0.5, 0, -1), 1e-12));
}

TEST_F(RobotFiles, LimitsFileMustHaveOneAccelerationPerJoint) {
  Write("r.urdf", kTwoJoints);
  for (const char* text : {"acceleration_rad_s2 = [1]\n", "acceleration_rad_s2 = [1, -2]\n", ""}) {
    Write("limits.toml", text);
    try {
      (void)ArmModel::Load(TwoJointConfig(), folder_);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), AllOf(HasSubstr("limits.toml"), HasSubstr("acceleration_rad_s2")));
    }
  }
}

TEST_F(RobotFiles, ConfigThatDoesNotFitTheUrdfIsRefused) {
  Write("r.urdf", kTwoJoints);
  Write("limits.toml", "acceleration_rad_s2 = [1, 2]\n");
  const auto error = [&](const auto& change) {
    RobotConfig config = TwoJointConfig();
    change(config);
    try {
      (void)ArmModel::Load(config, folder_);
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error([](RobotConfig& c) { c.tip_link = "hand"; }), HasSubstr("'hand'"));
  EXPECT_THAT(error([](RobotConfig& c) { c.base_link = "tip", c.tip_link = "a"; }),
              HasSubstr("tip_link"));
  EXPECT_THAT(error([](RobotConfig& c) { c.finger_joint_a = "j3"; }), HasSubstr("'j3'"));
  EXPECT_THAT(error([](RobotConfig& c) { c.waiting_deg = {150, 0}; }), HasSubstr("waiting_deg"));
  EXPECT_THAT(error([](RobotConfig& c) { c.gate_deg = {0}; }), HasSubstr("gate_deg"));
}

TEST_F(RobotFiles, ErrorsAreOneLineNamingFileAndElement) {
  struct Case {
    std::string urdf;
    std::vector<std::string> words;
  };
  const std::string mesh = R"(<link name="tip"><visual><geometry><mesh filename="%"/></geometry>
    </visual></link>)";
  const std::vector<Case> cases = {
      {"not xml", {"not a valid URDF"}},
      {"<robot name='r'/>", {"not a valid URDF"}},
      {Replaced(kTwoJoints, "0 2 0", "0 0 0"), {"joint 'j1'", "axis is zero"}},
      {Replaced(kTwoJoints, "<parent link=\"a\"/>", "<parent link=\"x\"/>"), {"[x]", "j2"}},
      {Replaced(kTwoJoints, "mass value=\"2\"", "mass value=\"-2\""), {"link 'a'", "-2"}},
      {Replaced(kTwoJoints, "lower=\"-2\"", "lower=\"3\""), {"joint 'j1'", "3.0", "2.0"}},
      {Replaced(kTwoJoints, "effort=\"100\"", "effort=\"0\""), {"joint 'j1'", "effort"}},
      {Replaced(kTwoJoints, "effort=\"100\"", "effort=\"1e300\""), {"effort = 1e+300", "1e+06"}},
      {Replaced(kTwoJoints, "velocity=\"1\"", "velocity=\"1e-12\""), {"joint 'j1'", "velocity"}},
      {Replaced(kTwoJoints, "upper=\"2\"", "upper=\"1e300\""), {"joint 'j1'", "limit upper"}},
      {Replaced(kTwoJoints, "mass value=\"2\"", "mass value=\"1e300\""), {"link 'a'", "mass"}},
      {Replaced(kTwoJoints, "xyz=\"1 0 0\"", "xyz=\"1e300 0 0\""), {"origin xyz", "[-100, 100]"}},
      {Replaced(kTwoJoints, "xyz=\"1 0 0\"", "xyz=\"nan 0 0\""), {"j2"}},
      {Replaced(kTwoJoints, "xyz=\"1 0 0\"", "xyz=\"1 0\""), {"j2"}},
      {Replaced(kTwoJoints, "type=\"fixed\"", "type=\"floating\""), {"joint 'j3'", "type"}},
      {Replaced(kTwoJoints, "ixx=\"0.1\"", "ixx=\"-0.1\""), {"link 'a'", "inertia"}},
      {Replaced(kTwoJoints, "<link name=\"tip\"/>", Replaced(mesh, "%", "gone.obj")),
       {"link 'tip'", "gone.obj", "no such mesh file"}},
      {Replaced(kTwoJoints, "<link name=\"tip\"/>", Replaced(mesh, "%", "package://p/m.obj")),
       {"link 'tip'", "package://p/m.obj"}},
      {Replaced(kTwoJoints, "<link name=\"tip\"/>",
                R"(<link name="tip"><collision><geometry><sphere radius="0"/></geometry>
                   </collision></link>)"),
       {"link 'tip'", "radius"}},
  };
  std::string deep, chain, comments = "<!--";
  for (int i = 0; i < 200; ++i) comments += " <a> << /> ";
  EXPECT_EQ(
      LoadError(Replaced(kTwoJoints, "<link name=\"tip\"/>", comments + "--><link name=\"tip\"/>")),
      LoadError(kTwoJoints));
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  for (int i = 0; i < 2000; ++i) chain += "<link name=\"l" + std::to_string(i) + "\"/>";
  for (int i = 1; i < 2000; ++i) {
    chain += "<joint name=\"j" + std::to_string(i) + "\" type=\"fixed\"><parent link=\"l" +
             std::to_string(i - 1) + "\"/><child link=\"l" + std::to_string(i) + "\"/></joint>";
  }
  EXPECT_THAT(LoadError("<robot name='r'>\n" + comments + "-->" + deep),
              HasSubstr("r.urdf:2: is nested deeper"));
  EXPECT_THAT(LoadError("<robot name='r'>\n" + deep), HasSubstr("r.urdf:2: is nested deeper"));
  EXPECT_THAT(LoadError("<robot name='r'>" + chain + "</robot>"), HasSubstr("has 2000 links"));
  for (const Case& c : cases) {
    const std::string error = LoadError(c.urdf);
    EXPECT_THAT(error, AllOf(HasSubstr("r.urdf"), Not(HasSubstr("\n")))) << c.urdf;
    for (const std::string& word : c.words) EXPECT_THAT(error, HasSubstr(word));
  }
}

TEST_F(RobotFiles, CollisionMeshBecomesItsBoundingBox) {
  Write("m.obj", "v 0 0 0\nv 2 0 0\nv 0 4 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const auto urdf = Write("r.urdf", Replaced(kTwoJoints, "<link name=\"tip\"/>",
                                             R"(<link name="tip"><collision><geometry>
                               <mesh filename="m.obj" scale="0.1 0.1 0.1"/></geometry></collision>
                               </link>)"));
  const RobotModel model = RobotModel::Load(urdf);
  const CollisionShape& shape = model.links()[*model.FindLink("tip")].collisions.at(0);
  EXPECT_EQ(shape.kind, CollisionShape::Kind::kBox);
  EXPECT_TRUE(shape.size_m.isApprox(Eigen::Vector3d(0.2, 0.4, 0.6), 1e-6));
  EXPECT_TRUE(shape.X_LS.translation().isApprox(Eigen::Vector3d(0.1, 0.2, 0.3), 1e-6));
}

TEST_F(RobotFiles, AMeshThatItsScaleMakesNothingOrEndlessIsRefused) {
  Write("m.obj", "v 0 0 0\nv 2 0 0\nv 0 4 0\nv 0 0 6\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  for (const char* scale : {"0 1 1", "1e38 1e38 1e38", "1000 1 1"}) {
    const std::string error = LoadError(Replaced(
        kTwoJoints, "<link name=\"tip\"/>",
        std::string("<link name=\"tip\"><collision><geometry><mesh filename=\"m.obj\" scale=\"") +
            scale + "\"/></geometry></collision></link>"));
    EXPECT_THAT(error, AllOf(HasSubstr("link 'tip'"), HasSubstr("scale"))) << scale;
  }
}

TEST_F(RobotFiles, BrokenMeshIsRefused) {
  EXPECT_THROW((void)LoadMeshFile(Write("bad.obj", "nothing here")), InputError);
  EXPECT_THROW((void)LoadMeshFile(folder_ / "none.obj"), InputError);
}

TEST(CollisionShapeDistance, AgreesWithClosedForms) {
  CollisionShape box{.name = "", .kind = CollisionShape::Kind::kBox, .size_m = {2, 4, 6}};
  EXPECT_DOUBLE_EQ(box.Distance({4, 0, 0}), 3);
  EXPECT_DOUBLE_EQ(box.Distance({4, 6, 3}), 5);
  EXPECT_DOUBLE_EQ(box.Distance({0.5, 0, 0}), -0.5);
  CollisionShape can{.name = "", .kind = CollisionShape::Kind::kCylinder, .size_m = {1, 0, 2}};
  EXPECT_DOUBLE_EQ(can.Distance({3, 4, 0}), 4);
  EXPECT_DOUBLE_EQ(can.Distance({0, 4, 5}), 5);
  EXPECT_DOUBLE_EQ(can.Distance({0, 0, 0.75}), -0.25);
  CollisionShape ball{.name = "", .kind = CollisionShape::Kind::kSphere, .size_m = {2, 0, 0}};
  EXPECT_DOUBLE_EQ(ball.Distance({0, 3, 4}), 3);
}

TEST(Iiwa, LoadsWithItsMeshesAndWeighsWhatItShould) {
  const RobotModel model =
      RobotModel::Load(std::filesystem::path(GUSSET_SOURCE_DIR) / "assets" / RobotConfig{}.urdf);
  double arm_kg = 0, gripper_kg = 0;
  std::size_t triangles = 0;
  for (const RobotLink& link : model.links()) {
    (link.name.starts_with("link_") ? arm_kg : gripper_kg) += link.mass_kg;
    for (const VisualMesh& visual : link.visuals) triangles += visual.mesh.triangles.size();
  }
  EXPECT_NEAR(arm_kg, 30.61, 0.005);  // the URDF's link masses and a 5 kg base
  EXPECT_NEAR(gripper_kg, 0.925, 1e-9);
  EXPECT_GT(triangles, 500u);
  EXPECT_LE(triangles, 10'000u);
}

TEST(Iiwa, WaitingPoseHoldsTheFingertipsWhereTheSceneExpectsThem) {
  const Eigen::Isometry3d X_WT = Iiwa().ToolPose(Iiwa().waiting());
  EXPECT_TRUE(X_WT.translation().isApprox(Eigen::Vector3d(-0.283, -0.723, 0.854), 1e-3));
  EXPECT_NEAR(X_WT.linear()(2, 2), -1, 1e-12);
}

TEST(Iiwa, PadsFaceEachOtherAtTheOpening) {
  std::vector<Eigen::Isometry3d> X_WL;
  for (const double opening_m : {0.0, 0.03, 0.085}) {
    Iiwa().LinkPoses(Iiwa().waiting(), opening_m, X_WL);
    const Eigen::Isometry3d X_TW = Iiwa().ToolPose(Iiwa().waiting()).inverse();
    const Eigen::Isometry3d X_TA = X_TW * X_WL[Iiwa().finger_link_a()];
    const Eigen::Isometry3d X_TB = X_TW * X_WL[Iiwa().finger_link_b()];
    EXPECT_TRUE(X_TA.translation().isApprox(Eigen::Vector3d(opening_m / 2, 0, 0), 1e-12) ||
                opening_m == 0);
    EXPECT_NEAR((X_TA.translation() - X_TB.translation()).norm(), opening_m, 1e-12);
    EXPECT_NEAR(X_TA.linear().col(0).dot(X_TB.linear().col(0)), -1, 1e-12);
  }
  EXPECT_NEAR(Iiwa().max_opening_m(), 0.085, 1e-12);
}

TEST(Iiwa, LinkPosesAndToolPoseAgree) {
  JointVector q = Iiwa().waiting();
  q << 0.3, -0.4, 0.5, -1.2, 0.7, 0.9, -1.1;
  std::vector<Eigen::Isometry3d> X_WL;
  Iiwa().LinkPoses(q, 0.01, X_WL);
  EXPECT_TRUE(X_WL[*Iiwa().robot().FindLink("tool")].isApprox(Iiwa().ToolPose(q), 1e-12));
}

TEST(Iiwa, JacobianIsTheDerivativeOfThePose) {
  JointVector q = Iiwa().waiting();
  q << 0.3, -0.4, 0.5, -1.2, 0.7, 0.9, -1.1;
  Eigen::Isometry3d X_WT;
  ToolJacobian J;
  Iiwa().ToolJacobianAt(q, X_WT, J);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 7; ++i) {
    JointVector moved = q;
    moved[i] += kStep;
    const Eigen::Isometry3d X = Iiwa().ToolPose(moved);
    const Eigen::AngleAxisd turn(X.linear() * X_WT.linear().transpose());
    // One-sided difference: error of the order of the step.
    EXPECT_LT(((X.translation() - X_WT.translation()) / kStep - J.col(i).head<3>()).norm(), 1e-5);
    EXPECT_LT((turn.angle() / kStep * turn.axis() - J.col(i).tail<3>()).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace gusset
