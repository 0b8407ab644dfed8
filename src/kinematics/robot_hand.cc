#include "kinematics/robot_hand.h"

#include <algorithm>
#include <numbers>

#include "base/error.h"
#include "kinematics/hand_layout.h"

namespace springgrasp {
namespace {

// Joints in canonical order, root at H.
KinematicTree Canonical(const KinematicTree& tree, const std::string& side,
                        const std::vector<std::string>& joint_names) {
  KinematicTree result = tree;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(tree.num_joints());
  std::vector<Pose> X_RB;
  ForwardKinematics(tree, zero, X_RB);
  const Pose X_HR = FramePose(tree, X_RB, tree.FrameIndex(side + "_H")).inverse();
  const int n = static_cast<int>(joint_names.size());
  std::vector<int> new_index(tree.num_joints(), -1);
  result.joint_names = joint_names;
  result.lower.resize(n);
  result.upper.resize(n);
  for (int j = 0; j < n; ++j) {
    const int old = tree.JointIndex(joint_names[j]);
    new_index[old] = j;
    result.lower[j] = tree.lower[old];
    result.upper[j] = tree.upper[old];
  }
  for (KinematicTree::Node& node : result.nodes) {
    if (node.parent < 0) node.X_PB = X_HR * node.X_PB;
    if (node.joint >= 0) node.joint = new_index[node.joint];
  }
  return result;
}

int NodeOfJoint(const KinematicTree& tree, int joint) {
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    if (tree.nodes[n].joint == joint) return static_cast<int>(n);
  }
  Fail("no body turns with joint '{}'", tree.joint_names[joint]);
}

// Rows of capsules along y that fill a box with rounded edges of radius r (box as the MJCF's:
// centre and half sizes in its body). `faces`: x and z positions of the rows.
void AddRows(int node, double centre_y, double half_y, double r,
             const std::vector<Eigen::Vector2d>& rows_xz, std::vector<LinkCapsule>& capsules) {
  for (const Eigen::Vector2d& xz : rows_xz) {
    capsules.push_back({node,
                        -1,
                        false,
                        {xz.x(), centre_y - half_y + r, xz.y()},
                        {xz.x(), centre_y + half_y - r, xz.y()},
                        r});
  }
}

}  // namespace

RobotHand MakeArmarHand(const KinematicTree& tree, const std::string& side) {
  RobotHand hand;
  hand.name = side;
  const auto& joints = tree.joint_names;
  const bool variant =
      std::find(joints.begin(), joints.end(), side + "_thumb_opposition") != joints.end();
  const HandLayout& layout = variant ? OppositionHand() : DocumentedHand();
  std::vector<std::string> names;
  for (const std::string_view joint : layout.joints) {
    names.push_back(side + "_" + std::string(joint));
  }
  hand.opposition = layout.opposition;
  hand.tree = Canonical(tree, side, names);
  hand.palm = 0;
  hand.tip_radius = 0.0093;
  hand.valves.resize(kNumValves);
  hand.valve_of = layout.valve_of_joint;
  for (int j = 0; j < layout.num_joints(); ++j) hand.valves[hand.valve_of[j]].push_back(j);
  hand.open = hand.tree.lower.cwiseMax(0.0);

  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, Eigen::VectorXd::Zero(hand.tree.num_joints()), X_HB);
  for (int f = 0; f < kNumFingers; ++f) {
    RobotHand::Finger& finger = hand.fingers[f];
    finger.j0 = 1 + 2 * f;
    finger.j1 = 2 + 2 * f;
    finger.base = NodeOfJoint(hand.tree, finger.j0);
    const int distal = NodeOfJoint(hand.tree, finger.j1);
    finger.tip = hand.tree.FrameIndex(side + "_" + std::string(kFingerNames[f]) + "_tip");
    const Eigen::Vector3d p_BTip = hand.tree.frames[finger.tip].X_BF.translation();
    const Eigen::Vector3d p_PB = hand.tree.nodes[distal].X_PB.translation();
    finger.length = p_PB.norm() + p_BTip.norm();
    hand.capsules.push_back({finger.base, f, false, Eigen::Vector3d::Zero(), p_PB, 0.008});
    // The last phalanx' axis runs parallel to the link through the pad's centre.
    const Eigen::Vector3d along = p_PB.normalized();
    const Eigen::Vector3d p_BStart = p_BTip + along * (0.0067 - along.dot(p_BTip));
    hand.capsules.push_back({distal, f, true, p_BStart, p_BTip, hand.tip_radius});
  }
  hand.fingers[kThumb].flexion_offset = {std::numbers::pi / 4, 0};

  const RobotHand::Finger& middle = hand.fingers[kMiddle];
  const Pose& X_HBase = X_HB[middle.base];
  const Eigen::Vector3d axis_H = X_HBase.linear() * hand.tree.nodes[middle.base].axis;
  const Eigen::Vector3d along_H =
      (X_HB[NodeOfJoint(hand.tree, middle.j1)].translation() - X_HBase.translation());
  // Flexion turns x towards -z, so the axis of flexion is +y of A.
  hand.R_HA = FrameFromXZ(along_H, along_H.cross(axis_H));

  // Palm: the metacarpal plate and the carpus block (boxes of models/armar3b), as rounded rows.
  const int plate = NodeOfJoint(hand.tree, hand.palm);
  const int carpus = hand.tree.nodes[plate].parent;
  ThrowUnless(carpus >= 0, "the tree of hand '{}' must begin at its hand body", side);
  const double mirror = side.back() == 'l' ? -1 : 1;
  std::vector<Eigen::Vector2d> rows;
  for (int i = 0; i < 5; ++i) rows.emplace_back(-0.001, 0.0031 + 0.00835 * i);
  AddRows(plate, mirror * 0.0331, 0.0449, 0.006, rows, hand.capsules);
  rows.clear();
  for (int i = 0; i < 8; ++i) rows.emplace_back(-0.0468 + 0.0088 * i, 0.0635);
  for (int i = 0; i < 4; ++i) rows.emplace_back(-0.0468, 0.0295 + 0.0085 * i);
  AddRows(carpus, mirror * 0.0224, 0.0462, 0.006, rows, hand.capsules);
  hand.p_HPalm = X_HB[plate] * Eigen::Vector3d(-0.007, mirror * 0.0331, 0.0198);
  return hand;
}

PerFinger<Eigen::Vector3d> TipPositions(const RobotHand& hand, const Eigen::VectorXd& q) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, q, X_HB);
  PerFinger<Eigen::Vector3d> tips;
  for (int f = 0; f < kNumFingers; ++f) {
    tips[f] = FramePose(hand.tree, X_HB, hand.fingers[f].tip).translation();
  }
  return tips;
}

}  // namespace springgrasp
