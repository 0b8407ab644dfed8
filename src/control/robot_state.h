// What the robot's own sensors tell, and what it may be commanded: plain values for controllers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>

#include "kinematics/hand_layout.h"

namespace springgrasp {

inline constexpr int kNumArmJoints = 7;
inline constexpr double kMaxPressureBar = 5.0;

using ArmVector = Eigen::Matrix<double, kNumArmJoints, 1>;
// One number for each joint of a hand, in its layout's order; never on the heap.
using HandVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxHandJoints, 1>;
using ValveVector = Eigen::Matrix<double, kNumValves, 1>;

// Order of the arm's joints and motors, shoulder to wrist (names without side prefix).
inline constexpr std::array<std::string_view, kNumArmJoints> kArmJointNames = {
    "shoulder1", "shoulder2", "upperarm", "elbow", "underarm", "wrist1", "wrist2"};
struct RobotState {
  double t = 0;                          // s, simulated
  ArmVector arm_q = ArmVector::Zero();   // rad
  ArmVector arm_qd = ArmVector::Zero();  // rad/s
  HandVector hand_q;                     // rad
  HandVector hand_qd;                    // rad/s
  HandVector hand_bias;  // Nm: gravity and Coriolis of the hand's links; empty: not known
  ValveVector pressure = ValveVector::Zero();  // bar, in the chambers
  // Joint-space inertia of the arm, hand included at its present posture (no held object), kg m^2.
  Eigen::Matrix<double, kNumArmJoints, kNumArmJoints> arm_mass =
      Eigen::Matrix<double, kNumArmJoints, kNumArmJoints>::Identity();
  ArmVector arm_bias = ArmVector::Zero();  // Nm: gravity and Coriolis of arm and hand
};

struct RobotCommand {
  ArmVector arm_torque = ArmVector::Zero();          // Nm; clipped to the motors' limits
  ValveVector valve_pressure = ValveVector::Zero();  // bar; clipped to the valves' range
};

}  // namespace springgrasp
