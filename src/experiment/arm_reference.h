// A sampled joint path as a reference for the arm controller.
#pragma once

#include <vector>

#include "control/arm_controller.h"

namespace springgrasp {

// Position, velocity and acceleration of a path of even steps `dt` (s) at time t: samples and
// their central differences, linearly interpolated; at rest outside the path. Not empty.
ArmTarget ArmReferenceAt(const std::vector<ArmVector>& path, double dt, double t);

// The hand's joints at time t, linearly interpolated; end values held.
HandVector HandReferenceAt(const std::vector<HandVector>& path, double dt, double t);

}  // namespace springgrasp
