// The shipped right arm, torso at zero.
#pragma once

#include "kinematics/arm_ik.h"
#include "real_models.h"

namespace springgrasp {

inline const Arm& TestArm() {
  static const Arm arm = [] {
    const auto model = LoadModel("armar3b/armar3b.xml");
    const KinematicTree tree = KinematicTreeOf(*model, "world", {"hand_r_H"});
    Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.num_joints());
    q[tree.JointIndex("arm_r_shoulder1")] = 0.2;
    q[tree.JointIndex("arm_r_elbow")] = 0.3;
    return MakeArm(tree, "hand_r_H", "arm_r_", q);
  }();
  return arm;
}

inline Eigen::VectorXd HomePosture(const Arm& arm) {
  Eigen::VectorXd q(arm.num_joints());
  for (int i = 0; i < arm.num_joints(); ++i) q[i] = arm.q[arm.joints[i]];
  return q;
}

}  // namespace springgrasp
