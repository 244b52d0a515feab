#pragma once

#include <string>
#include <vector>

#include "base/config.h"

namespace gusset {

/// Which robot stands where, and how it behaves: section [robot] of a scene. The defaults are an
/// iiwa 14 with a 2F-85 beside the table. Lists with one value per joint run from the base
/// outwards.
struct RobotConfig {
  std::string urdf = "robots/iiwa14_2f85/urdf/iiwa14_2f85.urdf";      ///< Relative to assets/.
  std::string joint_limits = "robots/iiwa14_2f85/joint_limits.toml";  ///< Relative to assets/.
  std::string base_link = "link_0";  ///< Start of the arm's chain; stands at base_m.
  std::string tip_link = "tool";     ///< End of the chain: the tool frame T.
  std::string finger_joint_a = "right_finger_joint";  ///< "" for an arm without a gripper.
  std::string finger_joint_b = "left_finger_joint";

  std::vector<double> base_m = {0, -0.44, 0.40};  ///< World position of the base link.
  double base_yaw_deg = 90;
  std::vector<double> waiting_deg = {135, 0, 0, -90, 0, 90, 0};
  /// A configuration beside the table that motions between the waiting pose and the table may pass
  /// through, where the straight way in joint space would come too near to the camera.
  std::vector<double> gate_deg = {16.7, 78.4, 43.6, -63.6, -53.7, 56.9, -85.8};
  /// Where the spare freedom of a redundant arm is drawn to, and how strongly (0: not at all). For
  /// the iiwa joints 3 and 5 at zero keep the elbow in the vertical plane through base and tool.
  std::vector<double> posture_deg = {-20, 30, 45, -90, 0, 60, 0};
  std::vector<double> posture_weight = {0, 0, 1, 0, 0.3, 0, 0};
  double limit_margin_deg = 3;        ///< Kept from the joints' position limits.
  double acceleration_share = 0.7;    ///< Of the acceleration limits; the rest is for stopping.
  double tool_acceleration_m_s2 = 2;  ///< Bound on a motion along its path; tuned.
  double travel_speed_m_s = 0.5;      ///< Of the tool on the way to the waiting pose.

  /// Radial tilt allowed, beyond what is asked, where that is unreachable; as much as a lift over
  /// the middle has. With 15 a cube beside the pedestal's corners could not be picked up.
  double max_tilt_deg = 30;
  double free_height_m = 0.15;    ///< Joint-space moves keep the fingertips above this.
  double base_keep_out_m = 0.17;  ///< Fingertips stay out of this cylinder round the base.
  std::vector<double> camera_m = {0, 0, 1.066};  ///< Centre of a body the links must not touch.
  double camera_half_length_m = 0.045;           ///< Half its length along world x.
  double camera_radius_m = 0.0125;               ///< Half its width; D435: 90 x 25 x 25 mm.
  double camera_clearance_m = 0.10;              ///< Left between it and any link.

  double torque_noise_Nm = 0.05;        ///< Standard deviation of one torque reading; tuned.
  double stop_force_N = 50;             ///< Tool force that answers with a protective stop.
  double finger_speed_min_m_s = 0.020;  ///< 2F-85 manual: 20-150 mm/s, 20-235 N.
  double finger_speed_max_m_s = 0.150;
  double grip_force_min_N = 20;
  double grip_force_max_N = 235;

  template <class V>
  void Fields(V& v) {
    v("urdf", urdf, {});
    v("joint_limits", joint_limits, {});
    v("base_link", base_link, {});
    v("tip_link", tip_link, {});
    v("finger_joint_a", finger_joint_a, {});
    v("finger_joint_b", finger_joint_b, {});
    v("base_m", base_m, {-5, 5});
    v("base_yaw_deg", base_yaw_deg, {-180, 180});
    v("waiting_deg", waiting_deg, {-360, 360});
    v("gate_deg", gate_deg, {-360, 360});
    v("posture_deg", posture_deg, {-360, 360});
    v("posture_weight", posture_weight, {0, 1});
    v("limit_margin_deg", limit_margin_deg, {0, 30});
    v("acceleration_share", acceleration_share, {0.1, 0.9});
    v("tool_acceleration_m_s2", tool_acceleration_m_s2, {0.1, 20});
    v("travel_speed_m_s", travel_speed_m_s, {0.01, 2});
    v("max_tilt_deg", max_tilt_deg, {0, 45});
    v("free_height_m", free_height_m, {0, 1});
    v("base_keep_out_m", base_keep_out_m, {0, 1});
    v("camera_m", camera_m, {-5, 5});
    v("camera_half_length_m", camera_half_length_m, {0, 1});
    v("camera_radius_m", camera_radius_m, {0, 1});
    v("camera_clearance_m", camera_clearance_m, {0, 1});
    v("torque_noise_Nm", torque_noise_Nm, {0, 10});
    v("stop_force_N", stop_force_N, {1, 1000});
    v("finger_speed_min_m_s", finger_speed_min_m_s, {0.001, 1});
    v("finger_speed_max_m_s", finger_speed_max_m_s, {0.001, 1});
    v("grip_force_min_N", grip_force_min_N, {0, 1000});
    v("grip_force_max_N", grip_force_max_N, {0, 1000});
  }
};

}  // namespace gusset
