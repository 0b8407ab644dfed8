#include "kinematics/kinematic_tree.h"

#include "base/error.h"

namespace springgrasp {
namespace {

template <typename Range, typename NameOf>
int IndexOf(const Range& range, std::string_view name, const char* what, NameOf name_of) {
  std::string names;
  for (std::size_t i = 0; i < range.size(); ++i) {
    if (name_of(range[i]) == name) return static_cast<int>(i);
    names += (i == 0 ? "" : ", ") + name_of(range[i]);
  }
  Fail("no {} named '{}', expected one of {}", what, name, names);
}

}  // namespace

int KinematicTree::JointIndex(std::string_view name) const {
  return IndexOf(joint_names, name, "joint", [](const std::string& n) { return n; });
}

int KinematicTree::FrameIndex(std::string_view name) const {
  return IndexOf(frames, name, "frame", [](const Frame& f) { return f.name; });
}

int KinematicTree::NodeIndex(std::string_view name) const {
  return IndexOf(nodes, name, "body", [](const Node& n) { return n.name; });
}

void ForwardKinematics(const KinematicTree& tree, const Eigen::Ref<const Eigen::VectorXd>& q,
                       std::vector<Pose>& X_RB) {
  X_RB.resize(tree.nodes.size());
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const KinematicTree::Node& node = tree.nodes[i];
    X_RB[i] = node.parent < 0 ? node.X_PB : X_RB[node.parent] * node.X_PB;
    if (node.joint < 0) continue;
    if (node.slide) {
      X_RB[i].translate(node.axis * q[node.joint]);
    } else {
      X_RB[i].rotate(Eigen::AngleAxisd(q[node.joint], node.axis));
    }
  }
}

Pose FramePose(const KinematicTree& tree, const std::vector<Pose>& X_RB, int frame) {
  return X_RB[tree.frames[frame].node] * tree.frames[frame].X_BF;
}

void FrameJacobian(const KinematicTree& tree, const std::vector<Pose>& X_RB, int frame,
                   Eigen::Ref<Eigen::MatrixXd> J) {
  J.setZero();
  const int body = tree.frames[frame].node;
  const Eigen::Vector3d p_RF = X_RB[body] * tree.frames[frame].X_BF.translation();
  for (int b = body; b >= 0; b = tree.nodes[b].parent) {
    const KinematicTree::Node& node = tree.nodes[b];
    if (node.joint < 0) continue;
    const Eigen::Vector3d axis_R = X_RB[b].linear() * node.axis;
    if (node.slide) {
      J.col(node.joint).head<3>() += axis_R;
    } else {
      J.col(node.joint).head<3>() += axis_R.cross(p_RF - X_RB[b].translation());
      J.col(node.joint).tail<3>() += axis_R;
    }
  }
}

Eigen::VectorXd GravityTorques(const KinematicTree& tree, const std::vector<Pose>& X_RB,
                               const Eigen::Vector3d& g_R) {
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(tree.num_joints());
  for (std::size_t body = 0; body < tree.nodes.size(); ++body) {
    if (tree.nodes[body].mass == 0) continue;
    const Eigen::Vector3d p_RC = X_RB[body] * tree.nodes[body].p_BC;
    const Eigen::Vector3d weight = tree.nodes[body].mass * g_R;
    for (int b = static_cast<int>(body); b >= 0; b = tree.nodes[b].parent) {
      const KinematicTree::Node& node = tree.nodes[b];
      if (node.joint < 0) continue;
      const Eigen::Vector3d axis_R = X_RB[b].linear() * node.axis;
      const Eigen::Vector3d moves =
          node.slide ? axis_R : Eigen::Vector3d(axis_R.cross(p_RC - X_RB[b].translation()));
      torque[node.joint] += moves.dot(weight);
    }
  }
  return torque;
}

}  // namespace springgrasp
