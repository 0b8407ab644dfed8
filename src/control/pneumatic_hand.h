// Position and torque control of a hand whose joints are driven by air chambers only.
//
// Model of one valve v with joints j: each joint feels  τ_j = g_v p_v − κ_v (q_j − q0_v),  the
// chamber fills as  τ_fill dp/dt = u − p,  0 ≤ u ≤ 5 bar. The controller asks for a torque,
// divides by g, and leads the chamber:  u = p* + lead (p* − p).
#pragma once

#include "control/robot_state.h"

namespace springgrasp {

// What the robot knows of its own chambers (models/armar3b/README.md says where from).
struct PneumaticHandModel {
  explicit PneumaticHandModel(const HandLayout& hand);
  HandLayout layout;
  ValveVector torque_per_bar;    // g, Nm/bar on each joint of the valve
  ValveVector return_stiffness;  // κ, Nm/rad
  ValveVector return_rest;       // q0, rad
};

// Gains act on torque, per radian of joint error (measured starting values: physics notes on a
// 0.1 s chamber; tuned with experiments/first_grasps, seeds below 1000).
struct PneumaticGains {
  double stiffness = 0.45;     // Nm/rad
  double integral = 0.15;      // Nm/(rad s)
  double damping = 0.02;       // Nm s/rad
  double lead = 1.5;           // of the pressure error
  double max_integral = 0.08;  // Nm, anti-windup
};

// What the hand shall do now.
struct HandTarget {
  HandVector q;           // desired joint angles, rad
  HandVector torque;      // added joint torque (grip), Nm; empty: none
  bool integrate = true;  // false holds the integral: the fingers press
};

struct HandControlState {
  ValveVector integral = ValveVector::Zero();  // Nm
};

// Valve commands (bar) for one control step of `dt` seconds. A valve with several joints gets the
// mean of what they ask for.
ValveVector ControlHand(const PneumaticHandModel& model, const PneumaticGains& gains,
                        const HandTarget& target, const RobotState& state, double dt,
                        HandControlState& memory);

// Steady joint angles of the hand in free space at given pressures (no gravity), rad.
HandVector FreeAnglesAt(const PneumaticHandModel& model, const ValveVector& pressure);

}  // namespace springgrasp
