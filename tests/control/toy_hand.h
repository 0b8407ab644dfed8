// A hand that needs no file.
#pragma once

#include <string>
#include <vector>

#include "base/fingers.h"
#include "kinematics/hand_layout.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// Five planar fingers of one link each, bases 20 mm apart along y; the thumb faces the others.
inline KinematicTree ToyHand() {
  KinematicTree tree;
  for (int j = 0; j < DocumentedHand().num_joints(); ++j) {
    KinematicTree::Node node;
    node.name = std::string(DocumentedHand().joints[j]);
    node.joint = j;
    // All bend towards each other by positive angles.
    node.axis = (j == 1 || j == 2 ? -1 : 1) * Eigen::Vector3d::UnitY();
    if (j > 0 && j % 2 == 0) {
      node.parent = j - 1;
      node.X_PB.translation() = Eigen::Vector3d(0.04, 0, 0);
    } else if (j > 0) {
      const int finger = (j - 1) / 2;
      node.X_PB.translation() = Eigen::Vector3d(0.1, -0.02 * finger, finger == kThumb ? -0.2 : 0);
    }
    tree.nodes.push_back(node);
    tree.joint_names.push_back(node.name);
  }
  for (int f = 0; f < kNumFingers; ++f) {
    KinematicTree::Frame tip;
    tip.name = "tip";
    tip.node = 2 + 2 * f;
    tip.X_BF.translation() = Eigen::Vector3d(0.05, 0, 0);
    tree.frames.push_back(tip);
  }
  tree.lower = Eigen::VectorXd::Constant(11, -1);
  tree.upper = Eigen::VectorXd::Constant(11, 1);
  return tree;
}

inline std::vector<Pose> BodiesAt(const KinematicTree& tree, const Eigen::VectorXd& q) {
  std::vector<Pose> X_RB;
  ForwardKinematics(tree, q, X_RB);
  return X_RB;
}

}  // namespace springgrasp
