// Limits of the robot's joints, motors and valves: what a trial asks beyond them is recorded.
#pragma once

#include "control/pneumatic_hand.h"
#include "sim/pneumatics.h"
#include "sim/robot_io.h"

namespace springgrasp {

// Largest excess of each kind over a trial; 0: none. What exceeds a limit is cut where it leaves
// the controllers (motors, valves), never in the plan.
struct LimitViolations {
  double arm_torque = 0;     // Nm, commanded beyond a motor's rating
  double arm_torque_s = 0;   // s, for so long
  double arm_range = 0;      // rad, planned beyond a joint's range
  double hand_range = 0;     // rad, the same
  double pressure_low = 0;   // bar below ambient that a planned hand posture needs to stand still:
                             // gravity bends a joint farther than its spring opens it
  double pressure_high = 0;  // bar above the supply, the same
  double valve_rate = 0;     // bar/s beyond the valves' `max_rate`
};

// Adds one control step: what the plan wants, and what the controllers command.
void WatchLimits(const RobotIo& robot, const PneumaticHandModel& hand,
                 const PneumaticParameters& pneumatics, const RobotState& state,
                 const ArmVector& arm_planned, const HandVector& hand_planned,
                 const RobotCommand& command, double dt, LimitViolations& violations);

}  // namespace springgrasp
