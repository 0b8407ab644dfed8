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

// The residuals of MappingOptions' table, with scratch space.
class MappingProblem {
 public:
  MappingProblem(const RobotHand& robot, const MappingTarget& target,
                 const Eigen::VectorXd& previous, const MappingOptions& options)
      : robot_(robot),
        target_(target),
        previous_(previous),
        options_(options),
        J_full_(6, robot.tree.num_joints()) {
    smooth_ = previous.size() == robot.tree.num_joints() && options.smoothness > 0;
    num_rows_ = 5 * kNumFingers + (robot.palm >= 0 ? 1 : 0) + (robot.opposition >= 0 ? 1 : 0);
    for (const std::vector<int>& valve : robot.valves) {
      const int n = static_cast<int>(valve.size());
      num_rows_ += n * (n - 1) / 2;
    }
    if (smooth_) num_rows_ += robot.tree.num_joints();
  }

  int num_rows() const { return num_rows_; }

  void Evaluate(const Eigen::VectorXd& q, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    ForwardKinematics(robot_.tree, q, X_HB_);
    if (J != nullptr) J->setZero();
    int row = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      const RobotHand::Finger& finger = robot_.fingers[f];
      r[row] = (q[finger.j0] - target_.sigma[f][0]) * kJointScale;
      r[row + 1] = (q[finger.j1] - target_.sigma[f][1]) * kJointScale;
      const double scale = std::sqrt(target_.lambda[f] / 3) / (2 * finger.length);
      r.segment<3>(row + 2) =
          scale * (FramePose(robot_.tree, X_HB_, finger.tip).translation() - target_.p_HF[f]);
      if (J != nullptr) {
        (*J)(row, finger.j0) = kJointScale;
        (*J)(row + 1, finger.j1) = kJointScale;
        FrameJacobian(robot_.tree, X_HB_, finger.tip, J_full_);
        J->middleRows<3>(row + 2) = scale * J_full_.topRows<3>();
      }
      row += 5;
    }
    const auto add = [&](double weight, int a, double wanted) {
      r[row] = weight * (q[a] - wanted);
      if (J != nullptr) (*J)(row, a) = weight;
      ++row;
    };
    if (robot_.palm >= 0) add(options_.palm_weight / kPi, robot_.palm, options_.palm_wanted);
    if (robot_.opposition >= 0) add(kJointScale, robot_.opposition, target_.opposition);
    for (const std::vector<int>& valve : robot_.valves) {
      for (std::size_t a = 0; a < valve.size(); ++a) {
        for (std::size_t b = a + 1; b < valve.size(); ++b) {
          const int k = row;
          add(options_.coupling_weight / kPi, valve[a], q[valve[b]]);
          if (J != nullptr) (*J)(k, valve[b]) = -options_.coupling_weight / kPi;
        }
      }
    }
    if (smooth_) {
      for (int j = 0; j < robot_.tree.num_joints(); ++j) {
        add(options_.smoothness / kPi, j, previous_[j]);
      }
    }
  }

 private:
  const RobotHand& robot_;
  const MappingTarget& target_;
  const Eigen::VectorXd& previous_;
  const MappingOptions& options_;
  bool smooth_ = false;
  int num_rows_ = 0;
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
  return q.cwiseMax(robot.tree.lower).cwiseMin(robot.tree.upper);
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
  problem.lower = robot.tree.lower;
  problem.upper = robot.tree.upper;
  problem.evaluate = [&rows](const Eigen::VectorXd& q, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    rows.Evaluate(q, r, J);
  };
  LevenbergMarquardtOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.gradient_tolerance = 1e-12;
  solver.step_tolerance = 1e-9;
  const bool warm = previous.size() == robot.tree.num_joints();
  LevenbergMarquardtResult solution = MinimizeLeastSquares(
      problem, warm ? previous : StartFromSigma(robot, target, options), solver);
  // The position term has two basins per finger (bent at the knuckle or at the middle joint): a
  // cold start looks into the other ones too.
  for (int f = 0; f < kNumFingers && !warm; ++f) {
    const RobotHand::Finger& finger = robot.fingers[f];
    for (const Eigen::Vector2d& part : kOtherStarts) {
      Eigen::VectorXd start = solution.x;
      const auto at = [&](int j, double s) {
        return robot.tree.lower[j] + s * (robot.tree.upper[j] - robot.tree.lower[j]);
      };
      start[finger.j0] = at(finger.j0, part[0]);
      start[finger.j1] = at(finger.j1, part[1]);
      const LevenbergMarquardtResult other = MinimizeLeastSquares(problem, start, solver);
      if (other.cost < solution.cost) solution = other;
    }
  }
  return Finish(robot, target, solution.x, 2 * solution.cost);
}

MappingResult MapHandByNlopt(const RobotHand& robot, const MappingTarget& target, int starts,
                             const MappingOptions& options) {
  const Eigen::VectorXd no_previous;
  MappingProblem rows(robot, target, no_previous, options);
  const int n = robot.tree.num_joints();
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
  solver.set_lower_bounds(bound(robot.tree.lower));
  solver.set_upper_bounds(bound(robot.tree.upper));
  solver.set_xtol_rel(1e-10);
  solver.set_ftol_rel(1e-14);
  solver.set_maxeval(500);
  RandomEngine engine = MakeStream(0, 0, "mapping yardstick");
  std::vector<double> best(n), x(n);
  double best_cost = std::numeric_limits<double>::infinity();
  for (int s = 0; s < starts; ++s) {
    const Eigen::VectorXd start = StartFromSigma(robot, target, options);
    for (int j = 0; j < n; ++j) {
      x[j] = s == 0 ? start[j] : Uniform(engine, robot.tree.lower[j], robot.tree.upper[j]);
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
  return Finish(robot, target, Eigen::Map<Eigen::VectorXd>(best.data(), n), best_cost);
}

}  // namespace springgrasp
