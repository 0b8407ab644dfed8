// The solid shapes of a robot in MuJoCo as plain values for planning.
#pragma once

#include <mujoco/mujoco.h>

#include "kinematics/arm_body.h"

namespace springgrasp {

// Links: the colliding shapes of the bodies from the upper arm on, with the hand as it is posed in
// `data` wrapped into capsules; the rest: all others of the same robot that the arm does not move,
// as posed. Exempt: what the model exempts. Shapes other than spheres, capsules, cylinders and
// boxes are left out.
ArmBody ArmBodyOf(const Arm& arm, const mjModel& model, const mjData& data);

}  // namespace springgrasp
