// Position and torque control of a hand whose joints are driven by air chambers only.
//
// Model of one valve v, its joints as one of their mean angle q:
//   I q̈ = g p − κ (q − q0) − d q̇ − f sign(q̇) − τ_g,   τ_fill ṗ = u − p,   0 ≤ u ≤ 5 bar.
//
// Position: a copy of this model (without friction) is driven to the target by state feedback
// within the supply's limits. What it does can be done, so the chamber is asked for the copy's
// pressure and friction, and the differences between copy and hand, small while the model is
// right, are what PI(D) acts on: nothing winds up while a step saturates the valve. Sensors that
// are `sensing_delay` late are compared with the copy as it was then.
// Pressing: torque about the measured angle, divided by g, with the chamber led:
//   u = p* + lead (p* − p).
#pragma once

#include <vector>

#include "base/random.h"
#include "control/robot_state.h"

namespace springgrasp {

// What the robot knows of its own hand (models/armar3b/README.md says where from).
struct PneumaticHandModel {
  explicit PneumaticHandModel(const HandLayout& hand);
  HandLayout layout;
  ValveVector torque_per_bar;    // g, Nm/bar on each joint of the valve
  ValveVector return_stiffness;  // κ, Nm/rad
  ValveVector return_rest;       // q0, rad
  ValveVector damping;           // d, Nm s/rad
  ValveVector friction;          // f, Nm
  ValveVector inertia;           // I, kg m^2
  ValveVector lower, upper;      // range of q, rad
  double fill_time = 0.1;        // s
  double gravity = 1;            // factor on the gravity torques that the state brings
};

// The model as one knows it who errs by up to `error` (0.2: 20 %) in each of fill time, g, κ, d,
// f, I of every valve, and of gravity: factors drawn evenly from 1 ± error.
PneumaticHandModel WithErrors(PneumaticHandModel model, double error, RandomEngine& engine);

// Gains act on torque, per radian of joint error; pressing, on that of a finger, and on as many
// times more as a valve is stronger. Tuned on a free finger (bench/finger_statistics, seeds below
// 1000).
struct PneumaticGains {
  double bandwidth = 32;            // rad/s, of the copy's angle
  double pressure_bandwidth = 110;  // rad/s, of the copy's pressure
  double stiffness = 0.45;          // Nm/rad
  double integral = 1.5;            // Nm/(rad s)
  double damping = 0.01;            // Nm s/rad
  double lead = 1.5;                // of the pressure error
  double max_integral = 0.08;       // Nm, anti-windup
  double integral_leak = 0;         // 1/s, of pressing valves: no push lasts
};

// What the hand shall do now.
struct HandTarget {
  HandVector q;                              // rad
  HandVector qd, qdd;                        // rad/s, rad/s^2; empty: zero
  HandVector torque;                         // Nm, of pressing valves; empty: none
  ValveVector offset = ValveVector::Zero();  // Nm, by which the model is known to err, added
  std::array<bool, kNumValves> pressing{};   // these press about q instead of following it
  double sensing_delay = 0;                  // s, known age of the state
};

struct HandControlState {
  // The copy of the model: mean angle, its speed, pressure. Ring of the past for late sensors.
  struct Copy {
    ValveVector q = ValveVector::Zero(), qd = q, pressure = q;
  };
  std::vector<Copy> past;
  std::size_t now = 0;
  bool started = false;
  ValveVector integral = ValveVector::Zero();  // Nm
};

// Valve commands (bar) for one control step of `dt` seconds.
ValveVector ControlHand(const PneumaticHandModel& model, const PneumaticGains& gains,
                        const HandTarget& target, const RobotState& state, double dt,
                        HandControlState& memory);

// Mean over the joints of each valve of a quantity per joint.
ValveVector MeanOfValves(const HandLayout& layout, const HandVector& of_joints);

// Steady joint angles of the hand in free space at given pressures (no gravity), rad.
HandVector FreeAnglesAt(const PneumaticHandModel& model, const ValveVector& pressure);

}  // namespace springgrasp
