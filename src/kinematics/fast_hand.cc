#include "kinematics/fast_hand.h"

#include <cmath>
#include <limits>

#include "base/error.h"

namespace springgrasp {

FastHand::FastHand(const RobotHand& robot) {
  ThrowUnless(robot.valves.size() <= kMostValves,
              "a hand to map to has at most {} valves, this one has {}", kMostValves,
              robot.valves.size());
  x_.setConstant(std::numeric_limits<double>::quiet_NaN());
  count_ = static_cast<int>(robot.tree.nodes.size());
  ThrowUnless(count_ <= kMostNodes, "a hand to map to has at most {} bodies, this one has {}",
              kMostNodes, count_);
  for (int i = 0; i < count_; ++i) {
    const KinematicTree::Node& node = robot.tree.nodes[i];
    Body& body = bodies_[i];
    body.parent = node.parent;
    body.valve = node.joint < 0 ? -1 : robot.valve_of[node.joint];
    ThrowUnless(!node.slide, "a hand to map to has hinges only, '{}' slides", node.name);
    body.p = node.X_PB.translation();
    body.fixed = node.X_PB.linear();
    if (body.valve < 0) continue;
    // X_PB turn(q) = fixed + cos q C + sin q S.
    const Eigen::Vector3d& a = node.axis;
    Eigen::Matrix3d cross;
    cross << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
    body.S = body.fixed * cross;
    body.C = -body.S * cross;
    body.fixed -= body.C;
    body.axis = a;
  }
}

void FastHand::Move(const ValveAngles& x) {
  if (x == x_) return;
  for (Eigen::Index v = 0; v < x.size(); ++v) {
    if (x[v] == x_[v]) continue;
    sin_[v] = std::sin(x[v]);
    cos_[v] = std::cos(x[v]);
  }
  x_ = x;
  for (int i = 0; i < count_; ++i) {
    Body& body = bodies_[i];
    Eigen::Matrix3d turn = body.fixed;
    if (body.valve >= 0) turn += cos_[body.valve] * body.C + sin_[body.valve] * body.S;
    if (body.parent < 0) {
      body.R_HB = turn;
      body.p_HB = body.p;
    } else {
      const Body& parent = bodies_[body.parent];
      body.R_HB.noalias() = parent.R_HB * turn;
      body.p_HB = parent.p_HB;
      body.p_HB.noalias() += parent.R_HB * body.p;
    }
  }
}

}  // namespace springgrasp
