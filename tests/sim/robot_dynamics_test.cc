#include <gtest/gtest.h>

#include "sim/robot/arm_sensors.h"
#include "tests/sim/robot_fixture.h"

namespace gusset {
namespace {

const JointVector kZero = JointVector::Zero(7);

JointVector AnyPose() {
  JointVector q(7);
  q << 0.3, 0.6, 0.5, -1.2, 0.7, 0.9, -1.1;
  return q;
}

// Potential energy of everything that moves; the torques against gravity are its gradient.
double Potential(const JointVector& q) {
  std::vector<Eigen::Isometry3d> X_WL;
  Iiwa().LinkPoses(q, 0, X_WL);
  double energy = 0;
  for (std::size_t l = 0; l < X_WL.size(); ++l) {
    const RobotLink& link = Iiwa().robot().links()[l];
    energy += link.mass_kg * 9.81 * (X_WL[l] * link.com_L).z();
  }
  return energy;
}

TEST(ArmDynamics, HoldingTorquesAreTheGradientOfThePotential) {
  ArmDynamics dynamics(Iiwa());
  const JointVector torques = dynamics.Torques(AnyPose(), kZero, kZero, Eigen::Vector3d::Zero());
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 7; ++i) {
    JointVector up = AnyPose(), down = AnyPose();
    up[i] += kStep;
    down[i] -= kStep;
    // Central difference: error ~ m g r step^2 ~ 1e-8; rounding 1e-16 * 300 J / 1e-5 ~ 1e-9.
    EXPECT_NEAR(torques[i], (Potential(up) - Potential(down)) / (2 * kStep), 1e-6) << i;
  }
}

TEST(ArmDynamics, StretchedArmHoldsItsMomentAboutTheShoulder) {
  ArmDynamics dynamics(Iiwa());
  JointVector q = kZero;
  q[1] = 90 * kDegree;
  std::vector<Eigen::Isometry3d> X_WL;
  Iiwa().LinkPoses(q, 0, X_WL);
  double moment = 0;
  for (std::size_t l = 0; l < X_WL.size(); ++l) {
    const RobotLink& link = Iiwa().robot().links()[l];
    if (link.name == "link_0" || link.name == "link_1") continue;
    moment += link.mass_kg * 9.81 * ((X_WL[l] * link.com_L).y() - Iiwa().X_WB().translation().y());
  }
  const JointVector torques = dynamics.Torques(q, kZero, kZero, Eigen::Vector3d::Zero());
  EXPECT_NEAR(std::abs(torques[1]), moment, 1e-9);
  EXPECT_GT(moment, 60);  // some 19 kg at some 0.45 m
}

TEST(ArmDynamics, WeightAtTheToolAddsItsLever) {
  ArmDynamics dynamics(Iiwa());
  const Eigen::Vector3d force(1, -2, -30);
  const JointVector loaded = dynamics.Torques(AnyPose(), kZero, kZero, force);
  const JointVector free = dynamics.Torques(AnyPose(), kZero, kZero, Eigen::Vector3d::Zero());
  Eigen::Isometry3d X_WT;
  ToolJacobian J;
  Iiwa().ToolJacobianAt(AnyPose(), X_WT, J);
  EXPECT_LT((loaded - free + J.topRows<3>().transpose() * force).norm(), 1e-9);
  EXPECT_LT((dynamics.ForceFromTorques(AnyPose(), loaded - free) - force).norm(), 1e-9);
}

TEST(ArmDynamics, AcceleratingTorquesFollowTheKineticEnergy) {
  // Power of the motors = change of kinetic and potential energy: here at zero speed the mass
  // matrix must be symmetric and positive.
  ArmDynamics dynamics(Iiwa());
  const JointVector rest = dynamics.Torques(AnyPose(), kZero, kZero, Eigen::Vector3d::Zero());
  Eigen::Matrix<double, 7, 7> M;
  for (int i = 0; i < 7; ++i) {
    JointVector qdd = kZero;
    qdd[i] = 1;
    M.col(i) = dynamics.Torques(AnyPose(), kZero, qdd, Eigen::Vector3d::Zero()) - rest;
  }
  EXPECT_LT((M - M.transpose()).norm(), 1e-9);
  EXPECT_EQ((M.llt().info()), Eigen::Success);
}

TEST(ArmSensors, ForceEstimateIsUnbiasedAndItsNoiseSmall) {
  ArmSensors sensors(Iiwa(), 1);
  const JointState rest{Iiwa().waiting(), kZero, kZero};
  const Eigen::Vector3d force(0.2, 0, -0.65);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0;
  constexpr int kReadings = 4000;
  for (int i = 0; i < kReadings; ++i) {
    const Eigen::Vector3d error = sensors.Force(rest, force) - force;
    sum += error;
    squares += error.squaredNorm();
  }
  const double sigma = std::sqrt(squares / kReadings);
  EXPECT_LT(sigma, 0.5);  // 0.05 Nm at levers of 0.3-0.5 m, three axes
  EXPECT_LT((sum / kReadings).norm(), 4 * sigma / std::sqrt(kReadings));
}

TEST(ArmSensors, SameSeedReadsTheSame) {
  ArmSensors a(Iiwa(), 7), b(Iiwa(), 8);
  const JointState rest{Iiwa().waiting(), kZero, kZero};
  const JointVector first = a.Torques(rest, Eigen::Vector3d::Zero());
  EXPECT_NE(first, b.Torques(rest, Eigen::Vector3d::Zero()));
  b.Seed(7);
  EXPECT_EQ(first, b.Torques(rest, Eigen::Vector3d::Zero()));
}

}  // namespace
}  // namespace gusset
