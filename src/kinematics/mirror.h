// The mirror image of the left side of a robot, as a right side: the world is mirrored across its
// plane x = 0, every body's and frame's own axes across their plane y = 0, so that the left hand's
// frame H (y away from its thumb) becomes a right one's. Joint angles stay what they are. What is
// planned for the image in the mirrored world is the left side's plan with its poses mirrored back.
#pragma once

#include "kinematics/arm_body.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// X_WB of the image for that of the body, and the other way round.
Pose MirroredBodyPose(const Pose& X_WB);
// The same of an object that is its own mirror image (sphere, cylinder, box): no axis is turned.
Pose MirroredObjectPose(const Pose& X_WO);
Eigen::Vector3d MirroredPoint(const Eigen::Vector3d& p_W);

// `in_world`: the tree's root is the world; else a body. "hand_l" and "arm_l" in names become
// "hand_r" and "arm_r".
KinematicTree MirroredTree(const KinematicTree& tree, bool in_world);
Arm MirroredArm(const Arm& arm);
ArmBody MirroredArmBody(const ArmBody& body);

}  // namespace springgrasp
