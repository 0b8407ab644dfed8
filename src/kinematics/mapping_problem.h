// The least squares behind hand_mapping.h, for its own solver and for NLopt.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "kinematics/fast_hand.h"
#include "kinematics/hand_mapping.h"

namespace springgrasp {

// The sum of squares of MappingOptions' table over one angle per valve, with scratch space.
class MappingProblem {
 public:
  static constexpr double kJointScale =  // n = 2 joints per finger
      1 / (std::numbers::pi * std::numbers::sqrt2);

  MappingProblem(const RobotHand& robot, const MappingTarget& target,
                 const Eigen::VectorXd& previous, const MappingOptions& options, FastHand& hand)
      : robot_(robot),
        target_(target),
        previous_(previous),
        options_(options),
        q_(robot.open),
        hand_(hand) {
    for (int f = 0; f < kNumFingers; ++f) {
      const double length = robot.fingers[f].length;
      tip_weight_[f] = target.lambda[f] / (3 * 4 * length * length);
    }
    lower.setZero();
    upper.setZero();
    for (int v = 0; v < num_valves(); ++v) {
      lower[v] = -std::numeric_limits<double>::infinity();
      upper[v] = -lower[v];
      for (const int j : robot.valves[v]) {
        lower[v] = std::max(lower[v], robot.tree.lower[j]);
        upper[v] = std::min(upper[v], robot.tree.upper[j]);
      }
    }
    warm_ = previous.size() == robot.tree.num_joints();
    if (warm_ && options.max_step > 0) {
      const ValveAngles from = Valves(previous).cwiseMax(lower).cwiseMin(upper);
      lower = lower.cwiseMax((from.array() - options.max_step).matrix());
      upper = upper.cwiseMin((from.array() + options.max_step).matrix());
    }
  }

  int num_valves() const { return static_cast<int>(robot_.valves.size()); }
  bool warm() const { return warm_; }

  // Joints of one chamber feel equal torque against equal springs: one angle.
  const Eigen::VectorXd& Joints(const ValveAngles& x) {
    for (int v = 0; v < num_valves(); ++v) {
      for (const int j : robot_.valves[v]) q_[j] = x[v];
    }
    return q_;
  }

  // The valves' angles nearest to joint angles: the mean of their joints.
  ValveAngles Valves(const Eigen::VectorXd& q) const {
    ValveAngles x = ValveAngles::Zero();
    for (int v = 0; v < num_valves(); ++v) {
      double sum = 0;
      for (const int j : robot_.valves[v]) sum += q[j];
      x[v] = sum / static_cast<double>(robot_.valves[v].size());
    }
    return x;
  }

  // Where the mapping starts: from the previous frame, or from the human's angles.
  ValveAngles Start() const {
    if (warm_) return Valves(previous_).cwiseMax(lower).cwiseMin(upper);
    Eigen::VectorXd q = robot_.open;
    for (int f = 0; f < kNumFingers; ++f) {
      q[robot_.fingers[f].j0] = target_.sigma[f][0];
      q[robot_.fingers[f].j1] = target_.sigma[f][1];
    }
    if (robot_.palm >= 0) q[robot_.palm] = options_.palm_wanted;
    if (robot_.opposition >= 0) q[robot_.opposition] = target_.opposition;
    return Valves(q).cwiseMax(lower).cwiseMin(upper);
  }

  // S' of Eq. (15) with our own rows: the sum of squares |r|^2.
  double Cost(const ValveAngles& x) {
    Joints(x);
    hand_.Move(x);
    double cost = 0;
    ForRows([&](double weight, int joint, double wanted) {
      const double r = weight * (q_[joint] - wanted);
      cost += r * r;
    });
    for (int f = 0; f < kNumFingers; ++f) {
      tip_error_[f] = TipError(f);
      squared_tip_errors_[f] = tip_error_[f].squaredNorm();
      cost += tip_weight_[f] * squared_tip_errors_[f];
    }
    return cost;
  }

  // Of |r|^2 / 2 where Cost was last taken: g = J'r; A = J'J and B, the rest of the second
  // derivatives (the sum of r times its own), both below the diagonal only.
  struct Derivatives {
    ValveAngles g;
    ValveMatrix A, B;
  };
  void Differentiate(Derivatives& d) const {
    d.A.setZero();
    d.B.setZero();
    for (int v = num_valves(); v < kMostValves; ++v) d.A(v, v) = 1;
    d.g = JointGradient(&d.A);
    for (int f = 0; f < kNumFingers; ++f) AddTip(f, d.g, &d);
  }
  ValveAngles Gradient() const {
    ValveAngles g = JointGradient(nullptr);
    for (int f = 0; f < kNumFingers; ++f) AddTip(f, g, nullptr);
    return g;
  }

  // Of the tips where Cost was last taken, m^2.
  const PerFinger<double>& squared_tip_errors() const { return squared_tip_errors_; }

  ValveAngles lower, upper;  // of the valves' angles, rad

 private:
  Eigen::Vector3d TipError(int f) const {
    const KinematicTree::Frame& frame = robot_.tree.frames[robot_.fingers[f].tip];
    const FastHand::Body& body = hand_.body(frame.node);
    return body.R_HB * frame.X_BF.translation() + body.p_HB - target_.p_HF[f];
  }

  // Calls row(weight, joint, wanted angle) for every residual of one joint.
  template <typename Row>
  void ForRows(const Row& row) const {
    for (int f = 0; f < kNumFingers; ++f) {
      row(kJointScale, robot_.fingers[f].j0, target_.sigma[f][0]);
      row(kJointScale, robot_.fingers[f].j1, target_.sigma[f][1]);
    }
    if (robot_.palm >= 0)
      row(options_.palm_weight / std::numbers::pi, robot_.palm, options_.palm_wanted);
    if (robot_.opposition >= 0) row(kJointScale, robot_.opposition, target_.opposition);
    if (warm_ && options_.smoothness > 0) {
      for (int j = 0; j < robot_.tree.num_joints(); ++j) {
        row(options_.smoothness / std::numbers::pi, j, previous_[j]);
      }
    }
  }

  ValveAngles JointGradient(ValveMatrix* A) const {
    ValveAngles g = ValveAngles::Zero();
    ForRows([&](double weight, int joint, double wanted) {
      const int v = robot_.valve_of[joint];
      g[v] += weight * weight * (q_[joint] - wanted);
      if (A != nullptr) (*A)(v, v) += weight * weight;
    });
    return g;
  }

  // The position term of a finger, by the joints between its tip and H.
  void AddTip(int f, ValveAngles& g, Derivatives* d) const {
    constexpr int kMostJoints = 8;
    const Eigen::Vector3d& e = tip_error_[f];
    const double weight = tip_weight_[f];
    const Eigen::Vector3d p_HF = e + target_.p_HF[f];
    std::array<Eigen::Vector3d, kMostJoints> axis, column;
    std::array<int, kMostJoints> valve;
    int count = 0;
    for (int b = robot_.tree.frames[robot_.fingers[f].tip].node; b >= 0; b = hand_.body(b).parent) {
      const FastHand::Body& body = hand_.body(b);
      if (body.valve < 0 || count == kMostJoints) continue;
      axis[count] = body.R_HB * body.axis;
      column[count] = axis[count].cross(p_HF - body.p_HB);
      valve[count++] = body.valve;
    }
    for (int i = 0; i < count; ++i) {
      g[valve[i]] += weight * column[i].dot(e);
      if (d == nullptr) continue;
      // d2p / dq_i dq_j: what the joint nearer to the tip does, turned by the other.
      const Eigen::Vector3d e_x_axis = e.cross(axis[i]);
      for (int j = 0; j <= i; ++j) {
        // Joints of one valve count twice, as (i, j) and as (j, i).
        const double times = j < i && valve[i] == valve[j] ? 2 * weight : weight;
        const int row = std::max(valve[i], valve[j]), col = std::min(valve[i], valve[j]);
        d->A(row, col) += times * column[i].dot(column[j]);
        d->B(row, col) += times * e_x_axis.dot(column[j]);
      }
    }
  }

  const RobotHand& robot_;
  const MappingTarget& target_;
  const Eigen::VectorXd& previous_;
  const MappingOptions& options_;
  bool warm_ = false;
  Eigen::VectorXd q_;
  FastHand& hand_;
  PerFinger<double> tip_weight_;
  PerFinger<Eigen::Vector3d> tip_error_;  // where Cost was last taken, m
  PerFinger<double> squared_tip_errors_ = {};
};

struct MappingSolution {
  ValveAngles x;
  double cost = 0;
  PerFinger<double> squared_tip_errors = {};
};

inline MappingResult ResultOf(MappingProblem& problem, const MappingSolution& solution) {
  MappingResult result;
  result.q = problem.Joints(solution.x);
  result.cost = solution.cost;
  for (int f = 0; f < kNumFingers; ++f) {
    result.tip_error[f] = std::sqrt(solution.squared_tip_errors[f]);
  }
  return result;
}

}  // namespace springgrasp
