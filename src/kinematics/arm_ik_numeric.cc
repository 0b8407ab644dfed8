#include "kinematics/arm_ik_numeric.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "kinematics/levenberg_marquardt.h"

namespace springgrasp {
namespace {

constexpr double kPositionUnit = 0.001;  // m that cost 1
constexpr double kRotationUnit = 0.005;  // rad that cost 1

// Pose error and preferences of one arm; scratch space included.
class ArmProblem {
 public:
  explicit ArmProblem(const Arm& arm) : arm_(arm), q_(arm.q), J_(6, arm.tree.num_joints()) {}

  // Inverse of the left Jacobian of the rotation exponential.
  static Eigen::Matrix3d InverseLeftJacobian(const Eigen::Vector3d& e) {
    Eigen::Matrix3d E;
    E << 0, -e.z(), e.y(), e.z(), 0, -e.x(), -e.y(), e.x(), 0;
    const double angle = e.norm();
    if (angle < 1e-5) return Eigen::Matrix3d::Identity() - 0.5 * E;
    // Written with the half angle, so that it stays finite up to pi.
    const double half = 0.5 * angle;
    const double factor = (1 - half / std::tan(half)) / (angle * angle);
    return Eigen::Matrix3d::Identity() - 0.5 * E + factor * E * E;
  }

  Pose PoseAt(const Eigen::VectorXd& x) {
    for (int i = 0; i < arm_.num_joints(); ++i) q_[arm_.joints[i]] = x[i];
    ForwardKinematics(arm_.tree, q_, X_WB_);
    return FramePose(arm_.tree, X_WB_, arm_.frame);
  }

  // Rows 0-2 position, 3-5 rotation, in their units.
  void PoseRows(const Pose& X_wanted, const Eigen::VectorXd& x, Eigen::VectorXd& r,
                Eigen::MatrixXd* J) {
    const Pose X_WH = PoseAt(x);
    const Eigen::Vector3d e =
        LogRotation(Eigen::Quaterniond(X_WH.linear() * X_wanted.linear().transpose()));
    r.head<3>() = (X_WH.translation() - X_wanted.translation()) / kPositionUnit;
    r.segment<3>(3) = e / kRotationUnit;
    if (J == nullptr) return;
    FrameJacobian(arm_.tree, X_WB_, arm_.frame, J_);
    const Eigen::Matrix3d turn = InverseLeftJacobian(e) / kRotationUnit;
    for (int i = 0; i < arm_.num_joints(); ++i) {
      J->col(i).head<3>() = J_.col(arm_.joints[i]).head<3>() / kPositionUnit;
      J->col(i).segment<3>(3) = turn * J_.col(arm_.joints[i]).tail<3>();
    }
  }

 private:
  const Arm& arm_;
  Eigen::VectorXd q_;
  std::vector<Pose> X_WB_;
  Eigen::MatrixXd J_;
};

struct Limits {
  Eigen::VectorXd lower, upper;
};

Limits LimitsOf(const Arm& arm, double margin) {
  Limits limits;
  limits.lower.resize(arm.num_joints());
  limits.upper.resize(arm.num_joints());
  for (int i = 0; i < arm.num_joints(); ++i) {
    limits.lower[i] = arm.tree.lower[arm.joints[i]] + margin;
    limits.upper[i] = arm.tree.upper[arm.joints[i]] - margin;
  }
  return limits;
}

}  // namespace

std::optional<Eigen::VectorXd> SolveArmNumerically(const Arm& arm, const Pose& X_WH,
                                                   const Eigen::VectorXd& start,
                                                   const ArmIkOptions& options,
                                                   double step_weight) {
  const int n = arm.num_joints();
  const Limits limits = LimitsOf(arm, options.margin);
  ArmProblem rows(arm);
  LeastSquaresProblem problem;
  problem.lower = limits.lower;
  problem.upper = limits.upper;
  const Eigen::VectorXd middle = 0.5 * (limits.lower + limits.upper);
  const Eigen::VectorXd scale =
      options.limit_weight * 2 * (limits.upper - limits.lower).cwiseInverse();
  problem.num_residuals = 6 + 2 * n;
  problem.evaluate = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    if (J != nullptr) J->setZero();
    rows.PoseRows(X_WH, x, r, J);
    r.segment(6, n) = scale.cwiseProduct(x - middle);
    r.tail(n) = step_weight * (x - start);
    if (J == nullptr) return;
    for (int i = 0; i < n; ++i) {
      (*J)(6 + i, i) = scale[i];
      (*J)(6 + n + i, i) = step_weight;
    }
  };
  LevenbergMarquardtOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.gradient_tolerance = 1e-9;
  solver.step_tolerance = 1e-6;
  Eigen::VectorXd x = MinimizeLeastSquares(problem, start, solver).x;
  problem.num_residuals = 6;
  problem.evaluate = [&](const Eigen::VectorXd& y, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    rows.PoseRows(X_WH, y, r, J);
  };
  // Worth it only where the pull alone keeps the pose off.
  const auto reached = [&](const Eigen::VectorXd& y, double part) {
    const Pose X = rows.PoseAt(y);
    return (X.translation() - X_WH.translation()).norm() <= part * options.position_tolerance &&
           LogRotation(Eigen::Quaterniond(X.linear() * X_WH.linear().transpose())).norm() <=
               part * options.rotation_tolerance;
  };
  if (!reached(x, 0.01)) {
    solver.max_iterations = 20;
    x = MinimizeLeastSquares(problem, x, solver).x;
  }
  if (!reached(x, 1)) return std::nullopt;
  return x;
}

std::optional<Eigen::VectorXd> SolveArmNumericallyFromAnywhere(
    const Arm& arm, const Pose& X_WH, const ArmIkOptions& options,
    const std::optional<Eigen::VectorXd>& near) {
  const int n = arm.num_joints();
  const Limits limits = LimitsOf(arm, options.margin);
  RandomEngine engine = MakeStream(0, 0, "arm starts");
  std::optional<Eigen::VectorXd> best;
  double best_score = 0;
  for (int s = 0; s < options.starts; ++s) {
    Eigen::VectorXd start(n);
    for (int i = 0; i < n; ++i) {
      start[i] = s == 0   ? arm.q[arm.joints[i]]
                 : s == 1 ? 0.5 * (limits.lower[i] + limits.upper[i])
                          : Uniform(engine, limits.lower[i], limits.upper[i]);
    }
    if (s == 0 && near) start = *near;
    const std::optional<Eigen::VectorXd> q = SolveArmNumerically(arm, X_WH, start, options, 0);
    if (!q) continue;
    double score = LimitMargin(arm, *q);
    if (near) score -= 0.1 * (*q - *near).cwiseAbs().maxCoeff();
    if (!best || score > best_score) {
      best = q;
      best_score = score;
    }
  }
  return best;
}

}  // namespace springgrasp
