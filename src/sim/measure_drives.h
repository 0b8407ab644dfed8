// What the drives of a hand do, measured in simulation: step responses and blocked pad forces.
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

namespace springgrasp {

// One valve set from 0 to `pressure`, the hand free, the rest of the robot held, no gravity.
struct DriveStep {
  std::string valve;
  double pressure = 0;              // bar, commanded
  double time_constant = 0;         // s, until the chamber holds 63.2 % of it
  double rise_time = 0;             // s, until the first joint has 90 % of its way
  std::vector<std::string> joints;  // driven by the valve
  std::vector<double> steady;       // rad, where they come to rest
  std::vector<double> balance;      // rad, where chamber and spring balance, within the range
  std::vector<double> t, p, q;      // s, bar, rad (first joint), every time step
};
// `duration`, s. Throws Error if the model has no such valve.
DriveStep MeasureDriveStep(const mjModel& model, const std::string& valve, double pressure,
                           double duration = 2);

// The finger at q (rad, both joints alike), its pad held in place, its valves at `pressure`: force
// of the pad (N) along its outward normal, no gravity. `hand`: hand_r or hand_l.
double MeasurePadForce(const mjModel& model, const std::string& hand, const std::string& finger,
                       double q, double pressure);

// Pressure (bar) that balances the return spring in the middle of the range of the valve's joint.
double MidPressure(const mjModel& model, const std::string& valve);

// Valves of the model in its order: the hands' actuators with a pressure.
std::vector<std::string> ValvesOf(const mjModel& model);

}  // namespace springgrasp
