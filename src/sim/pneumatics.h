// The pneumatic drives of a hand: what its MJCF carries, and the small part that it cannot.
//
// One chamber per valve. With u the commanded and p the chamber's pressure (bar above ambient):
//   dp/dt = (c − p) / fill_time − leakage p,      exhaust ≤ c ≤ supply,  |c − p| ≤ fill_time rate
//   τ_j   = 1e5 Pa/bar · area · lever · p − spring (q_j − q0) − damping q̇_j − friction sign(q̇_j)
// where c follows u after `delay` with the play `hysteresis` of the valve's spool. MuJoCo's filter
// actuator integrates p and the model holds chamber, lever, spring, damping and friction; delay,
// play, rate and leakage act on its control here, noise and delay on what the sensors tell.
// A valve that serves several joints puts one pressure on all: equal torque, not equal angle.
#pragma once

#include <mujoco/mujoco.h>

#include <optional>
#include <vector>

#include "base/random.h"
#include "control/robot_state.h"

namespace springgrasp {

// Of a finger's drive; the palm's has twice the area, spring and friction. Unset: as the model's
// file says. The last eight are off by default.
struct PneumaticParameters {
  std::optional<double> fill_time;  // s
  std::optional<double> supply;     // bar
  std::optional<double> area;       // cm^2, effective, of the bellows
  std::optional<double> lever;      // cm, from the joint to the bellows' line of force
  std::optional<double> spring;     // Nm/rad, of the return spring
  std::optional<double> damping;    // Nm s/rad
  std::optional<double> friction;   // Nm
  double leakage = 0;               // 1/s: share of the pressure lost per second
  double delay = 0;                 // s, from command to valve
  double hysteresis = 0;            // bar, full width of the valve's play
  double max_rate = 0;              // bar/s through the valve; 0: no limit
  double pressure_noise = 0;        // bar, deviation of a pressure reading
  double angle_noise = 0;           // rad, deviation of a joint angle reading
  double sensing_delay = 0;         // s, age of every reading of the hand
  double model_error = 0;           // the controller's model of the hand errs by up to this part
};

// Writes the parameters into a compiled model: all hand_?_* joints and valves of both sides.
// `area` and `lever` alone keep the model's other factor (1 cm^2 and 1 cm in models/armar3b).
void ApplyPneumatics(const PneumaticParameters& parameters, mjModel& model);

// Valves and sensors of one hand, stepped with the simulation. Without delay, play, rate, leakage
// and noise it passes commands and readings through unchanged and draws no number.
class PneumaticDrives {
 public:
  // `dt`: time between two commands, s. `engine`: stream "actuation" of the trial.
  PneumaticDrives(const PneumaticParameters& parameters, double dt, RandomEngine engine);

  // Controls of the model's valves (bar) for the commands u, given the true chamber pressures.
  ValveVector Step(const ValveVector& command, const ValveVector& pressure);
  // What the hand's sensors tell of a true state: late and noisy angles and pressures. Once there
  // is noise or delay, speeds are differences of the angles read, smoothed over kSpeedFilter.
  void Sense(RobotState& state);
  static constexpr double kSpeedFilter = 0.01;  // s

 private:
  struct Reading {
    HandVector q, bias;
    ValveVector pressure;
  };
  PneumaticParameters parameters_;
  double dt_, fill_time_, supply_;
  std::vector<ValveVector> waiting_;  // ring of delayed commands
  std::size_t next_ = 0;
  std::vector<Reading> readings_;  // ring of delayed readings
  std::size_t next_reading_ = 0;
  HandVector last_q_, speed_;
  ValveVector spool_ = ValveVector::Zero();  // command behind the play, bar
  RandomEngine engine_;
};

}  // namespace springgrasp
