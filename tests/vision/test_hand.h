// A hand model for tests, without a file.
#pragma once

#include <string>

#include "base/fingers.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// A hand of the usual proportions, fingers along x, thumb on the y side; every flexion bends
// towards -z. The joints carry the names that the model is read by.
inline KinematicTree TestHand() {
  KinematicTree tree;
  tree.nodes.push_back({"hand", -1, Pose::Identity(), -1, Eigen::Vector3d::UnitZ(), false});
  const auto add = [&](const std::string& name, int parent, const Eigen::Vector3d& p,
                       const Eigen::Vector3d& axis, double lower, double upper) {
    Pose X = Pose::Identity();
    X.translation() = p;
    tree.nodes.push_back({name, parent, X, tree.num_joints(), axis, false});
    tree.joint_names.push_back(name);
    tree.lower.conservativeResize(tree.num_joints());
    tree.upper.conservativeResize(tree.num_joints());
    tree.lower[tree.num_joints() - 1] = lower;
    tree.upper[tree.num_joints() - 1] = upper;
    return static_cast<int>(tree.nodes.size()) - 1;
  };
  const auto tip = [&](const std::string& finger, int node, double length) {
    Pose X = Pose::Identity();
    X.translation() = Eigen::Vector3d(length, 0, 0);
    tree.frames.push_back({"mmm_" + finger + "_tip", node, X});
  };
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ(), y = Eigen::Vector3d::UnitY();
  int node = add("mmm_thumb_cmc_opposition", 0, {0.014, 0.0185, 0}, z, 0.3, 1.2);
  node = add("mmm_thumb_cmc_flexion", node, {0, 0, 0}, y, -0.5, 0.8);
  node = add("mmm_thumb_mcp", node, {0.037, 0, 0}, y, 0, 1.5);
  tip("thumb", node, 0.045);
  const double side[4] = {0.0237, 0, -0.0195, -0.038}, reach[4] = {0.0845, 0.0843, 0.0773, 0.0696};
  const double bone[4] = {0.046, 0.050, 0.046, 0.0385};
  for (int f = 1; f < kNumFingers; ++f) {
    const std::string name = "mmm_" + std::string(kFingerNames[f]);
    node = add(name + "_abduction", 0, {reach[f - 1], side[f - 1], 0}, z, -0.35, 0.35);
    node = add(name + "_mcp", node, {0, 0, 0}, y, 0, 1.57);
    node = add(name + "_pip", node, {bone[f - 1], 0, 0}, y, 0, 1.57);
    node = add(name + "_dip", node, {0.62 * bone[f - 1], 0, 0}, y, 0, 1.57);
    tip(std::string(kFingerNames[f]), node, 0.013);
  }
  return tree;
}

}  // namespace springgrasp
