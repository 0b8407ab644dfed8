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

  // S' of Eq. (15) with our own rows: the sum of squares |r|^2; A = J'J and g = J'r where wanted,
  // and the rest of the second derivatives, B = sum of r times its own.
  struct Curvature {
    ValveMatrix A, B;
  };
  double Evaluate(const ValveAngles& x, Curvature* curvature, ValveAngles* g) {
    Joints(x);
    hand_.Move(x);
    ValveMatrix* A = nullptr;
    if (curvature != nullptr) {
      A = &curvature->A;
      A->setZero();
      curvature->B.setZero();
      for (int v = num_valves(); v < kMostValves; ++v) (*A)(v, v) = 1;
    }
    if (g != nullptr) g->setZero();
    double cost = 0;
    const auto add = [&](double weight, int joint, double wanted) {
      const int v = robot_.valve_of[joint];
      const double r = weight * (q_[joint] - wanted);
      cost += r * r;
      if (A != nullptr) (*A)(v, v) += weight * weight;
      if (g != nullptr) (*g)[v] += weight * r;
    };
    for (int f = 0; f < kNumFingers; ++f) {
      const RobotHand::Finger& finger = robot_.fingers[f];
      add(kJointScale, finger.j0, target_.sigma[f][0]);
      add(kJointScale, finger.j1, target_.sigma[f][1]);
      AddTip(f, curvature, g, cost);
    }
    if (robot_.palm >= 0)
      add(options_.palm_weight / std::numbers::pi, robot_.palm, options_.palm_wanted);
    if (robot_.opposition >= 0) add(kJointScale, robot_.opposition, target_.opposition);
    if (warm_ && options_.smoothness > 0) {
      for (int j = 0; j < robot_.tree.num_joints(); ++j) {
        add(options_.smoothness / std::numbers::pi, j, previous_[j]);
      }
    }
    return cost;
  }

  // Of the tips at the last evaluation, m^2.
  const PerFinger<double>& squared_tip_errors() const { return squared_tip_errors_; }

  ValveAngles lower, upper;  // of the valves' angles, rad

 private:
  Eigen::Vector3d TipError(int f) const {
    const KinematicTree::Frame& frame = robot_.tree.frames[robot_.fingers[f].tip];
    const FastHand::Body& body = hand_.body(frame.node);
    return body.R_HB * frame.X_BF.translation() + body.p_HB - target_.p_HF[f];
  }

  // The position term of a finger, by the joints between its tip and H.
  void AddTip(int f, Curvature* curvature, ValveAngles* g, double& cost) {
    constexpr int kMostJoints = 8;
    const RobotHand::Finger& finger = robot_.fingers[f];
    const Eigen::Vector3d e = TipError(f);
    const double weight = target_.lambda[f] / (3 * 4 * finger.length * finger.length);
    squared_tip_errors_[f] = e.squaredNorm();
    cost += weight * squared_tip_errors_[f];
    if (g == nullptr) return;
    const Eigen::Vector3d p_HF = e + target_.p_HF[f];
    std::array<Eigen::Vector3d, kMostJoints> axis, column;
    std::array<int, kMostJoints> valve;
    int count = 0;
    for (int b = robot_.tree.frames[finger.tip].node; b >= 0; b = hand_.body(b).parent) {
      const FastHand::Body& body = hand_.body(b);
      if (body.valve < 0 || count == kMostJoints) continue;
      axis[count] = body.R_HB * body.axis;
      column[count] = axis[count].cross(p_HF - body.p_HB);
      valve[count++] = body.valve;
    }
    for (int i = 0; i < count; ++i) {
      (*g)[valve[i]] += weight * column[i].dot(e);
      if (curvature == nullptr) continue;
      // d2p / dq_i dq_j: what the joint nearer to the tip does, turned by the other.
      for (int j = 0; j <= i; ++j) {
        const double a = weight * column[i].dot(column[j]);
        const double b = weight * e.dot(axis[i].cross(column[j]));
        curvature->A(valve[i], valve[j]) += a;
        curvature->B(valve[i], valve[j]) += b;
        if (j == i) continue;
        curvature->A(valve[j], valve[i]) += a;
        curvature->B(valve[j], valve[i]) += b;
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
