// Torque control of the arm along a joint trajectory:
//   τ = M(q) (q̈_d + 2 ω (q̇_d − q̇) + ω² (q_d − q) + I) + b(q, q̇) + τ_ff,   İ = ω_i³ (q_d − q)
// Critically damped error dynamics at bandwidth ω while M and b are exact; τ_ff carries the load.
#pragma once

#include "control/robot_state.h"

namespace springgrasp {

struct ArmTarget {
  ArmVector q = ArmVector::Zero();                   // rad
  ArmVector qd = ArmVector::Zero();                  // rad/s
  ArmVector qdd = ArmVector::Zero();                 // rad/s^2
  ArmVector feedforward_torque = ArmVector::Zero();  // Nm
};

struct ArmGains {
  double bandwidth = 30;          // ω, rad/s
  double integral_bandwidth = 6;  // ω_i, rad/s
  double max_integral = 20;       // rad/s^2, anti-windup
};

struct ArmControlState {
  ArmVector integral = ArmVector::Zero();  // rad/s^2
};

// Joint torques (Nm, before the motors' limits) for one control step of `dt` seconds.
ArmVector ControlArm(const ArmGains& gains, const ArmTarget& target, const RobotState& state,
                     double dt, ArmControlState& memory);

}  // namespace springgrasp
