// Kinematics of a MuJoCo model as plain values.
#pragma once

#include <mujoco/mujoco.h>

#include <string>
#include <vector>

#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// The tree below `root_body` ("world" for everything); the root R is that body's frame, its own
// joints are left out, node 0 is the root body itself. Sites become frames. With `leaves` (names
// of bodies or sites) only the bodies on the paths from the root to them are taken, with all
// sites on these. Bodies with free or ball joints (objects) are left out with all below them,
// unless asked for as a leaf: then Error. Joints without limits get +-pi (hinge), +-10 m (slide).
// E.g. the arm in the world: KinematicTreeOf(model, "world", {"hand_r_H"});
//      the human hand:       KinematicTreeOf(model, "mmm_hand").
KinematicTree KinematicTreeOf(const mjModel& model, const std::string& root_body,
                              const std::vector<std::string>& leaves = {});

// Positions of the tree's joints out of a state. Same order as tree.joint_names.
Eigen::VectorXd JointPositions(const KinematicTree& tree, const mjModel& model, const mjData& data);

}  // namespace springgrasp
