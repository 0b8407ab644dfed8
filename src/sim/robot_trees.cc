#include "sim/robot_trees.h"

#include <algorithm>

#include "base/error.h"
#include "control/robot_state.h"
#include "sim/kinematic_tree_of.h"

namespace springgrasp {
namespace {

template <std::size_t n>
std::vector<std::string> Prefixed(const std::string& prefix,
                                  const std::array<std::string_view, n>& names) {
  std::vector<std::string> prefixed;
  for (const std::string_view name : names) prefixed.push_back(prefix + std::string(name));
  return prefixed;
}

}  // namespace

KinematicTree WithJointOrder(KinematicTree tree, const std::vector<std::string>& names) {
  ThrowUnless(std::is_permutation(names.begin(), names.end(), tree.joint_names.begin(),
                                  tree.joint_names.end()),
              "the model's joints are {}; expected {}", fmt::join(tree.joint_names, ", "),
              fmt::join(names, ", "));
  const Eigen::VectorXd lower = tree.lower, upper = tree.upper;
  for (KinematicTree::Node& node : tree.nodes) {
    if (node.joint < 0) continue;
    const auto place = std::find(names.begin(), names.end(), tree.joint_names[node.joint]);
    const int to = static_cast<int>(place - names.begin());
    tree.lower[to] = lower[node.joint];
    tree.upper[to] = upper[node.joint];
    node.joint = to;
  }
  tree.joint_names = names;
  return tree;
}

KinematicTree RobotArmTree(const mjModel& model, const std::string& side) {
  return WithJointOrder(KinematicTreeOf(model, "world", {"hand_" + side + "_H"}),
                        Prefixed("arm_" + side + "_", kArmJointNames));
}

KinematicTree RobotHandTree(const mjModel& model, const std::string& side) {
  KinematicTree tree = WithJointOrder(KinematicTreeOf(model, "hand_" + side),
                                      Prefixed("hand_" + side + "_", kHandJointNames));
  // H is fixed to the hand's base: make it the root.
  const Pose X_BH = tree.frames[tree.FrameIndex("hand_" + side + "_H")].X_BF;
  for (KinematicTree::Node& node : tree.nodes) {
    if (node.parent < 0) node.X_PB = X_BH.inverse() * node.X_PB;
  }
  return tree;
}

}  // namespace springgrasp
