// A sampled joint path as a reference for the arm controller.
#pragma once

#include <vector>

#include "base/pose.h"
#include "control/arm_controller.h"
#include "kinematics/arm_ik.h"

namespace springgrasp {

// Position, velocity and acceleration of a path of even steps `dt` (s) at time t: samples and
// their central differences, linearly interpolated; at rest outside the path. Not empty.
ArmTarget ArmReferenceAt(const std::vector<ArmVector>& path, double dt, double t);

// The hand's joints, their speeds and accelerations at time t, in the same way.
struct HandReference {
  HandVector q, qd, qdd;  // rad, rad/s, rad/s^2
};
HandReference HandReferenceAt(const std::vector<HandVector>& path, double dt, double t);

// Torques (Nm) that carry `mass` (kg) at X_HO in the hand, J' (m g), at arm angles `q`.
ArmVector LoadTorque(const Arm& arm, const ArmVector& q, const Pose& X_HO, double mass);

}  // namespace springgrasp
