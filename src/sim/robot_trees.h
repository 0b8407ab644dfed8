// The robot's arm and hand as kinematic trees in the joint order of RobotState.
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// The tree with its joints renumbered to `names`. Throws Error unless both name the same joints.
KinematicTree WithJointOrder(KinematicTree tree, const std::vector<std::string>& names);

// World to hand frame: joints in the order of kArmJointNames, frame hand_<side>_H. Joints of other
// active subsystems (torso) are not part of it: Error if one lies on the way.
KinematicTree RobotArmTree(const mjModel& model, const std::string& side = "r");

// The hand with root H: joints in the order of kHandJointNames, frames hand_<side>_<finger>_tip.
KinematicTree RobotHandTree(const mjModel& model, const std::string& side = "r");

}  // namespace springgrasp
