// What the robot did, as a table that numpy and spreadsheets read.
#pragma once

#include <string>
#include <vector>

#include "experiment/perform.h"

namespace springgrasp {

// One row per sample: t, phase, poses of object, hand and planned hand (x y z qw qx qy qz, m),
// fingertips (m), normal forces (N), joints (rad), pressures (bar), torques (Nm), commands.
std::string FormatTrajectory(const std::vector<TrajectorySample>& trajectory,
                             const HandLayout& hand);

}  // namespace springgrasp
