// Kinematics of a tree of rigid bodies as plain values: hands and arms alike. Knows nothing of
// MuJoCo (sim/kinematic_tree_of.h makes one from a model).
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "base/pose.h"

namespace springgrasp {

struct KinematicTree {
  // A body. Its pose in the root R: X_RB = X_RP * X_PB * motion(axis, q[joint]).
  struct Node {
    std::string name;
    int parent = -1;                                  // -1: the root R; parents stand first
    Pose X_PB = Pose::Identity();                     // at q = 0, m
    int joint = -1;                                   // index into q; -1: fixed to its parent
    Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  // in B, through B's origin
    bool slide = false;                               // hinge (rad) or slide (m)
    double mass = 0;                                  // kg; 0: not known
    Eigen::Vector3d p_BC = Eigen::Vector3d::Zero();   // centre of that mass, m
  };
  // A named frame fixed to a body (a site).
  struct Frame {
    std::string name;
    int node = -1;
    Pose X_BF = Pose::Identity();
  };
  std::vector<Node> nodes;
  std::vector<Frame> frames;
  std::vector<std::string> joint_names;
  Eigen::VectorXd lower, upper;  // joint ranges, rad (or m)

  int num_joints() const { return static_cast<int>(joint_names.size()); }
  // Index by name; throws Error listing the names that exist.
  int JointIndex(std::string_view name) const;
  int FrameIndex(std::string_view name) const;
  int NodeIndex(std::string_view name) const;
};

// Poses X_RB of all bodies at joint positions q (size num_joints). `X_RB` is resized once, so
// repeated calls allocate nothing.
void ForwardKinematics(const KinematicTree& tree, const Eigen::Ref<const Eigen::VectorXd>& q,
                       std::vector<Pose>& X_RB);

// Pose X_RF of a frame, given the body poses.
Pose FramePose(const KinematicTree& tree, const std::vector<Pose>& X_RB, int frame);

// Geometric Jacobian of a frame's origin and rotation in R: rows 0-2 linear (m/rad), rows 3-5
// angular. `J` must be 6 x num_joints; columns of joints that do not move the frame are zero.
void FrameJacobian(const KinematicTree& tree, const std::vector<Pose>& X_RB, int frame,
                   Eigen::Ref<Eigen::MatrixXd> J);

// Torques (forces) with which gravity `g_R` (m/s^2) turns the joints, from the masses of the
// bodies.
Eigen::VectorXd GravityTorques(const KinematicTree& tree, const std::vector<Pose>& X_RB,
                               const Eigen::Vector3d& g_R);

}  // namespace springgrasp
