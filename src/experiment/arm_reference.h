// A sampled joint path as a reference for the arm controller.
#pragma once

#include <vector>

#include "control/arm_controller.h"

namespace springgrasp {

// Position, velocity and acceleration of a path of even steps `dt` (s) at time t: samples and
// their central differences, linearly interpolated; at rest outside the path. Not empty.
ArmTarget ArmReferenceAt(const std::vector<ArmVector>& path, double dt, double t);

// The hand's joints, their speeds and accelerations at time t, in the same way.
struct HandReference {
  HandVector q, qd, qdd;  // rad, rad/s, rad/s^2
};
HandReference HandReferenceAt(const std::vector<HandVector>& path, double dt, double t);

}  // namespace springgrasp
