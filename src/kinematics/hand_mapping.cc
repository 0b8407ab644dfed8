#include "kinematics/hand_mapping.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlopt.hpp>
#include <numbers>

#include "base/random.h"
#include "kinematics/levenberg_marquardt.h"

namespace springgrasp {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kJointScale = 1 / (kPi * std::numbers::sqrt2);  // n = 2 joints per finger

const std::array<Eigen::Vector2d, 4> kOtherStarts = {
    Eigen::Vector2d(0.1, 0.9), Eigen::Vector2d(0.9, 0.1), Eigen::Vector2d(0.3, 0.3),
    Eigen::Vector2d(0.8, 0.8)};  // of the ranges of j0, j1

// The residuals of MappingOptions' table over one angle per valve, with scratch space.
class MappingProblem {
 public:
  MappingProblem(const RobotHand& robot, const MappingTarget& target,
                 const Eigen::VectorXd& previous, const MappingOptions& options)
      : robot_(robot),
        target_(target),
        previous_(previous),
        options_(options),
        q_(robot.open),
        J_full_(6, robot.tree.num_joints()) {
    const int n = num_valves();
    lower = Eigen::VectorXd::Constant(n, -std::numeric_limits<double>::infinity());
    upper = -lower;
    for (int v = 0; v < n; ++v) {
      for (const int j : robot.valves[v]) {
        lower[v] = std::max(lower[v], robot.tree.lower[j]);
        upper[v] = std::min(upper[v], robot.tree.upper[j]);
      }
    }
    const bool warm = previous.size() == robot.tree.num_joints();
    if (warm && options.max_step > 0) {
      const Eigen::VectorXd from = Valves(previous).cwiseMax(lower).cwiseMin(upper);
      lower = lower.cwiseMax((from.array() - options.max_step).matrix());
      upper = upper.cwiseMin((from.array() + options.max_step).matrix());
    }
    smooth_ = warm && options.smoothness > 0;
    num_rows_ = 5 * kNumFingers + (robot.palm >= 0 ? 1 : 0) + (robot.opposition >= 0 ? 1 : 0);
    if (smooth_) num_rows_ += robot.tree.num_joints();
  }

  int num_rows() const { return num_rows_; }
  int num_valves() const { return static_cast<int>(robot_.valves.size()); }

  // Joints of one chamber feel equal torque against equal springs: one angle.
  const Eigen::VectorXd& Joints(const Eigen::VectorXd& x) {
    for (int v = 0; v < num_valves(); ++v) {
      for (const int j : robot_.valves[v]) q_[j] = x[v];
    }
    return q_;
  }

  // The valves' angles nearest to joint angles: the mean of their joints.
  Eigen::VectorXd Valves(const Eigen::VectorXd& q) const {
    Eigen::VectorXd x(num_valves());
    for (int v = 0; v < num_valves(); ++v) {
      double sum = 0;
      for (const int j : robot_.valves[v]) sum += q[j];
      x[v] = sum / static_cast<double>(robot_.valves[v].size());
    }
    return x;
  }

  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    Joints(x);
    ForwardKinematics(robot_.tree, q_, X_HB_);
    if (J != nullptr) J->setZero();
    int row = 0;
    const auto add = [&](double weight, int joint, double wanted) {
      r[row] = weight * (q_[joint] - wanted);
      if (J != nullptr) (*J)(row, robot_.valve_of[joint]) += weight;
      ++row;
    };
    for (int f = 0; f < kNumFingers; ++f) {
      const RobotHand::Finger& finger = robot_.fingers[f];
      add(kJointScale, finger.j0, target_.sigma[f][0]);
      add(kJointScale, finger.j1, target_.sigma[f][1]);
      const double scale = std::sqrt(target_.lambda[f] / 3) / (2 * finger.length);
      r.segment<3>(row) =
          scale * (FramePose(robot_.tree, X_HB_, finger.tip).translation() - target_.p_HF[f]);
      if (J != nullptr) {
        FrameJacobian(robot_.tree, X_HB_, finger.tip, J_full_);
        for (int j = 0; j < robot_.tree.num_joints(); ++j) {
          J->col(robot_.valve_of[j]).segment<3>(row) += scale * J_full_.col(j).head<3>();
        }
      }
      row += 3;
    }
    if (robot_.palm >= 0) add(options_.palm_weight / kPi, robot_.palm, options_.palm_wanted);
    if (robot_.opposition >= 0) add(kJointScale, robot_.opposition, target_.opposition);
    if (smooth_) {
      for (int j = 0; j < robot_.tree.num_joints(); ++j) {
        add(options_.smoothness / kPi, j, previous_[j]);
      }
    }
  }

  Eigen::VectorXd lower, upper;  // of the valves' angles, rad

 private:
  const RobotHand& robot_;
  const MappingTarget& target_;
  const Eigen::VectorXd& previous_;
  const MappingOptions& options_;
  bool smooth_ = false;
  int num_rows_ = 0;
  Eigen::VectorXd q_;
  std::vector<Pose> X_HB_;
  Eigen::MatrixXd J_full_;
};

Eigen::VectorXd StartFromSigma(const RobotHand& robot, const MappingTarget& target,
                               const MappingOptions& options) {
  Eigen::VectorXd q = robot.open;
  for (int f = 0; f < kNumFingers; ++f) {
    q[robot.fingers[f].j0] = target.sigma[f][0];
    q[robot.fingers[f].j1] = target.sigma[f][1];
  }
  if (robot.palm >= 0) q[robot.palm] = options.palm_wanted;
  if (robot.opposition >= 0) q[robot.opposition] = target.opposition;
  return q;
}

MappingResult Finish(const RobotHand& robot, const MappingTarget& target, Eigen::VectorXd q,
                     double cost) {
  MappingResult result;
  const PerFinger<Eigen::Vector3d> tips = TipPositions(robot, q);
  for (int f = 0; f < kNumFingers; ++f) result.tip_error[f] = (tips[f] - target.p_HF[f]).norm();
  result.q = std::move(q);
  result.cost = cost;
  return result;
}

}  // namespace

MappingTarget TargetFromHuman(const HumanHand& human, const Eigen::VectorXd& q_human,
                              const RobotHand& robot) {
  MappingTarget target;
  target.lambda.fill(1);
  if (robot.opposition >= 0) {
    target.opposition =
        std::clamp(kPi / 2 - OppositionOf(human, q_human), robot.tree.lower[robot.opposition],
                   robot.tree.upper[robot.opposition]);
  }
  const PerFinger<FlexionAngles> flexion = FlexionOf(human, q_human);
  std::vector<Pose> X_human, X_robot;
  ForwardKinematics(human.tree, q_human, X_human);
  ForwardKinematics(robot.tree, robot.open, X_robot);
  for (int f = 0; f < kNumFingers; ++f) {
    const RobotHand::Finger& finger = robot.fingers[f];
    const Eigen::Vector2d wanted =
        Eigen::Vector2d(flexion[f].proximal, flexion[f].distal) + finger.flexion_offset;
    target.sigma[f][0] =
        std::clamp(wanted[0], robot.tree.lower[finger.j0], robot.tree.upper[finger.j0]);
    target.sigma[f][1] =
        std::clamp(wanted[1], robot.tree.lower[finger.j1], robot.tree.upper[finger.j1]);
    const Eigen::Vector3d reach = FramePose(human.tree, X_human, human.tip[f]).translation() -
                                  X_human[human.base[f]].translation();
    target.p_HF[f] =
        X_robot[finger.base].translation() + finger.length / human.length[f] * (robot.R_HA * reach);
  }
  return target;
}

MappingResult MapHand(const RobotHand& robot, const MappingTarget& target,
                      const Eigen::VectorXd& previous, const MappingOptions& options) {
  MappingProblem rows(robot, target, previous, options);
  LeastSquaresProblem problem;
  problem.num_residuals = rows.num_rows();
  problem.lower = rows.lower;
  problem.upper = rows.upper;
  problem.evaluate = [&rows](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    rows.Evaluate(x, r, J);
  };
  LevenbergMarquardtOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.gradient_tolerance = 1e-9;
  solver.step_tolerance = 1e-6;
  const bool warm = previous.size() == robot.tree.num_joints();
  const Eigen::VectorXd start =
      rows.Valves(warm ? previous : StartFromSigma(robot, target, options));
  LevenbergMarquardtResult solution = MinimizeLeastSquares(problem, start, solver);
  // The position term has two basins per finger (bent at the knuckle or at the middle joint): a
  // cold start looks into the other ones too.
  for (int f = 0; f < kNumFingers && !warm; ++f) {
    const int v0 = robot.valve_of[robot.fingers[f].j0], v1 = robot.valve_of[robot.fingers[f].j1];
    for (const Eigen::Vector2d& part : kOtherStarts) {
      Eigen::VectorXd other_start = solution.x;
      other_start[v0] = rows.lower[v0] + part[0] * (rows.upper[v0] - rows.lower[v0]);
      other_start[v1] = rows.lower[v1] + part[1] * (rows.upper[v1] - rows.lower[v1]);
      const LevenbergMarquardtResult other = MinimizeLeastSquares(problem, other_start, solver);
      if (other.cost < solution.cost) solution = other;
    }
  }
  return Finish(robot, target, rows.Joints(solution.x), 2 * solution.cost);
}

std::vector<MappingResult> MapHandAlong(const RobotHand& robot,
                                        const std::vector<MappingTarget>& targets, int anchor,
                                        const MappingOptions& options) {
  const int n = static_cast<int>(targets.size());
  std::vector<MappingResult> results(targets.size());
  if (n == 0) return results;
  anchor = std::clamp(anchor, 0, n - 1);
  results[anchor] = MapHand(robot, targets[anchor], {}, options);
  for (int k = anchor - 1; k >= 0; --k) {
    results[k] = MapHand(robot, targets[k], results[k + 1].q, options);
  }
  for (int k = anchor + 1; k < n; ++k) {
    results[k] = MapHand(robot, targets[k], results[k - 1].q, options);
  }
  return results;
}

MappingResult MapHandByNlopt(const RobotHand& robot, const MappingTarget& target, int starts,
                             const Eigen::VectorXd& previous, const MappingOptions& options) {
  MappingProblem rows(robot, target, previous, options);
  const int n = rows.num_valves();
  Eigen::VectorXd q(n), r(rows.num_rows());
  Eigen::MatrixXd J(rows.num_rows(), n);
  nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(n));
  const nlopt::vfunc cost = [](const std::vector<double>& x, std::vector<double>& gradient,
                               void* context) {
    return (*static_cast<std::function<double(const std::vector<double>&, std::vector<double>&)>*>(
        context))(x, gradient);
  };
  std::function<double(const std::vector<double>&, std::vector<double>&)> evaluate =
      [&](const std::vector<double>& x, std::vector<double>& gradient) {
        q = Eigen::Map<const Eigen::VectorXd>(x.data(), n);
        rows.Evaluate(q, r, gradient.empty() ? nullptr : &J);
        if (!gradient.empty()) {
          Eigen::Map<Eigen::VectorXd>(gradient.data(), n) = 2 * J.transpose() * r;
        }
        return r.squaredNorm();
      };
  solver.set_min_objective(cost, &evaluate);
  const auto bound = [n](const Eigen::VectorXd& v) {
    return std::vector<double>(v.data(), v.data() + n);
  };
  solver.set_lower_bounds(bound(rows.lower));
  solver.set_upper_bounds(bound(rows.upper));
  solver.set_xtol_abs(1e-6);
  solver.set_ftol_rel(1e-12);
  solver.set_maxeval(500);
  RandomEngine engine = MakeStream(0, 0, "mapping yardstick");
  std::vector<double> best(n), x(n);
  double best_cost = std::numeric_limits<double>::infinity();
  const bool warm = previous.size() == robot.tree.num_joints();
  const Eigen::VectorXd start =
      rows.Valves(warm ? previous : StartFromSigma(robot, target, options))
          .cwiseMax(rows.lower)
          .cwiseMin(rows.upper);
  for (int s = 0; s < starts; ++s) {
    for (int v = 0; v < n; ++v) {
      x[v] = s == 0 ? start[v] : Uniform(engine, rows.lower[v], rows.upper[v]);
    }
    double found = 0;
    try {
      solver.optimize(x, found);
    } catch (const std::runtime_error&) {
      // Round-off at the optimum: x is still the best point so far.
    }
    std::vector<double> none;
    found = evaluate(x, none);
    if (found < best_cost) {
      best_cost = found;
      best = x;
    }
  }
  return Finish(robot, target, rows.Joints(Eigen::Map<Eigen::VectorXd>(best.data(), n)), best_cost);
}

}  // namespace springgrasp
