// What the robot's own sensors tell, and what it may be commanded: plain values for controllers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

namespace springgrasp {

inline constexpr int kNumArmJoints = 7;
inline constexpr int kNumHandJoints = 11;
inline constexpr int kNumValves = 8;
inline constexpr double kMaxPressureBar = 5.0;

using ArmVector = Eigen::Matrix<double, kNumArmJoints, 1>;
using HandVector = Eigen::Matrix<double, kNumHandJoints, 1>;
using ValveVector = Eigen::Matrix<double, kNumValves, 1>;

// Order of the arm's joints and motors, shoulder to wrist (names without side prefix).
inline constexpr std::array<std::string_view, kNumArmJoints> kArmJointNames = {
    "shoulder1", "shoulder2", "upperarm", "elbow", "underarm", "wrist1", "wrist2"};
// Order of the hand's joints: palm, then j0 (proximal) and j1 (distal) of each finger 0..4. The
// joints of finger f are 1 + 2 f and 2 + 2 f.
inline constexpr std::array<std::string_view, kNumHandJoints> kHandJointNames = {
    "palm",      "thumb_j0", "thumb_j1", "index_j0",  "index_j1", "middle_j0",
    "middle_j1", "ring_j0",  "ring_j1",  "pinkie_j0", "pinkie_j1"};
// Order of the valves. The last one drives all four joints of ring finger and pinkie.
inline constexpr std::array<std::string_view, kNumValves> kValveNames = {
    "palm",         "thumb_proximal",  "thumb_distal",  "index_proximal",
    "index_distal", "middle_proximal", "middle_distal", "ring_pinkie"};

struct RobotState {
  double t = 0;                                // s, simulated
  ArmVector arm_q = ArmVector::Zero();         // rad
  ArmVector arm_qd = ArmVector::Zero();        // rad/s
  HandVector hand_q = HandVector::Zero();      // rad
  HandVector hand_qd = HandVector::Zero();     // rad/s
  ValveVector pressure = ValveVector::Zero();  // bar, in the chambers
  // Joint-space inertia of the arm, hand included at its present posture (no held object), kg m^2.
  Eigen::Matrix<double, kNumArmJoints, kNumArmJoints> arm_mass =
      Eigen::Matrix<double, kNumArmJoints, kNumArmJoints>::Identity();
  ArmVector arm_bias = ArmVector::Zero();  // Nm: gravity and Coriolis of arm and hand
};

struct RobotCommand {
  ArmVector arm_torque = ArmVector::Zero();          // Nm; clipped to the motors' limits
  ValveVector valve_pressure = ValveVector::Zero();  // bar, 0 to kMaxPressureBar; clipped
};

}  // namespace springgrasp
