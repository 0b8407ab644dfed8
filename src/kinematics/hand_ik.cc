#include "kinematics/hand_ik.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "kinematics/levenberg_marquardt.h"

namespace springgrasp {
namespace {

// A warm start that ends farther than this from the tip may try again from rest, and jumps there
// if that is much nearer.
constexpr double kRetryError = 0.010, kRetryGood = 0.002;  // m

LevenbergMarquardtOptions SolverOptions(const HandIkOptions& options) {
  LevenbergMarquardtOptions solver;
  solver.max_iterations = options.max_iterations;
  solver.gradient_tolerance = 1e-6;
  solver.step_tolerance = 1e-7;
  return solver;
}

// Rows of HandIkOptions for one finger but the tip rows; appended from `row` on. `column[i]` is the
// column of the finger's joint i.
class PostureRows {
 public:
  PostureRows(const HumanHand& hand, int finger, const Eigen::VectorXd& previous,
              const HandIkOptions& options)
      : hand_(hand), finger_(finger), previous_(previous), options_(options) {}

  int count() const {
    const int n = static_cast<int>(hand_.joints[finger_].size());
    return n + (previous_.size() > 0 ? n : 0) + (finger_ == kThumb ? 0 : 1);
  }

  void Fill(const Eigen::VectorXd& q, int first_column, int row, Eigen::VectorXd& r,
            Eigen::MatrixXd* J) const {
    const std::vector<int>& joints = hand_.joints[finger_];
    const int n = static_cast<int>(joints.size());
    for (int i = 0; i < n; ++i) {
      const bool abduction = finger_ != kThumb && i == n - 4;
      const double weight =
          1 / (abduction ? options_.abduction_deviation : options_.rest_deviation);
      r[row] = weight * (q[joints[i]] - hand_.rest[joints[i]]);
      if (J != nullptr) (*J)(row, first_column + i) = weight;
      ++row;
    }
    if (previous_.size() > 0) {
      for (int i = 0; i < n; ++i, ++row) {
        r[row] = (q[joints[i]] - previous_[joints[i]]) / options_.step_deviation;
        if (J != nullptr) (*J)(row, first_column + i) = 1 / options_.step_deviation;
      }
    }
    if (finger_ != kThumb) {
      const double weight = 1 / options_.coupling_deviation;
      r[row] = weight * (q[joints[n - 1]] - 2.0 / 3 * q[joints[n - 2]]);
      if (J != nullptr) {
        (*J)(row, first_column + n - 1) = weight;
        (*J)(row, first_column + n - 2) = -2.0 / 3 * weight;
      }
    }
  }

 private:
  const HumanHand& hand_;
  const int finger_;
  const Eigen::VectorXd& previous_;
  const HandIkOptions& options_;
};

// One finger: its joints from the tip in H, written into q.
void SolveFinger(const HumanHand& hand, int finger, const Eigen::Vector3d& p_HF,
                 const Eigen::VectorXd& previous, const HandIkOptions& options,
                 const Eigen::VectorXd& start, Eigen::VectorXd& q) {
  const std::vector<int>& joints = hand.joints[finger];
  const int n = static_cast<int>(joints.size());
  const PostureRows posture(hand, finger, previous, options);
  std::vector<Pose> X_HB;
  Eigen::MatrixXd J_full(6, hand.tree.num_joints());
  LeastSquaresProblem problem;
  problem.num_residuals = 3 + posture.count();
  problem.lower.resize(n);
  problem.upper.resize(n);
  Eigen::VectorXd x(n);
  for (int i = 0; i < n; ++i) {
    problem.lower[i] = hand.tree.lower[joints[i]];
    problem.upper[i] = hand.tree.upper[joints[i]];
    x[i] = start[joints[i]];
  }
  problem.evaluate = [&](const Eigen::VectorXd& values, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    for (int i = 0; i < n; ++i) q[joints[i]] = values[i];
    ForwardKinematics(hand.tree, q, X_HB);
    r.head<3>() =
        (FramePose(hand.tree, X_HB, hand.tip[finger]).translation() - p_HF) / options.tip_deviation;
    if (J != nullptr) {
      J->setZero();
      FrameJacobian(hand.tree, X_HB, hand.tip[finger], J_full);
      for (int i = 0; i < n; ++i) {
        J->col(i).head<3>() = J_full.col(joints[i]).head<3>() / options.tip_deviation;
      }
    }
    posture.Fill(q, 0, 3, r, J);
  };
  const LevenbergMarquardtResult result = MinimizeLeastSquares(problem, x, SolverOptions(options));
  for (int i = 0; i < n; ++i) q[joints[i]] = result.x[i];
}

PerFinger<double> TipErrors(const HumanHand& hand, const Eigen::VectorXd& q, const Pose& X_WH,
                            const KnownTips& p_WF) {
  PerFinger<double> error = {};
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, q, X_HB);
  for (int f = 0; f < kNumFingers; ++f) {
    if (!p_WF[f]) continue;
    error[f] = (X_WH * FramePose(hand.tree, X_HB, hand.tip[f]).translation() - *p_WF[f]).norm();
  }
  return error;
}

Eigen::Matrix3d Cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Right Jacobian of the rotation exponential: exp(w + dw) = exp(w) exp(Jr dw).
Eigen::Matrix3d RightJacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = Cross(w);
  if (angle < 1e-6) return Eigen::Matrix3d::Identity() - 0.5 * W;
  const double a2 = angle * angle;
  return Eigen::Matrix3d::Identity() - (1 - std::cos(angle)) / a2 * W +
         (angle - std::sin(angle)) / (a2 * angle) * W * W;
}

}  // namespace

HandIkResult SolveHandIk(const HumanHand& hand, const KnownTips& p_HF,
                         const Eigen::VectorXd& previous, const HandIkOptions& options) {
  HandIkResult result;
  const bool warm = previous.size() == hand.tree.num_joints();
  const Eigen::VectorXd start = warm ? previous : hand.rest;
  const Eigen::VectorXd held = warm ? previous : Eigen::VectorXd();
  result.q = start;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!p_HF[f]) {
      // Glides back to rest instead of jumping there.
      for (const int j : hand.joints[f]) {
        const double pull = std::clamp(hand.rest[j] - start[j], -0.02, 0.02);
        result.q[j] = warm ? start[j] + pull : hand.rest[j];
      }
      continue;
    }
    SolveFinger(hand, f, *p_HF[f], held, options, start, result.q);
    if (warm && TipErrors(hand, result.q, Pose::Identity(), p_HF)[f] > kRetryError) {
      Eigen::VectorXd q = result.q;
      SolveFinger(hand, f, *p_HF[f], {}, options, hand.rest, q);
      if (TipErrors(hand, q, Pose::Identity(), p_HF)[f] < kRetryGood) result.q = q;
    }
  }
  result.error = TipErrors(hand, result.q, Pose::Identity(), p_HF);
  return result;
}

std::vector<Eigen::VectorXd> SolveHandMotion(const HumanHand& hand,
                                             const std::vector<KnownTips>& p_HF,
                                             const HandIkOptions& options) {
  std::vector<Eigen::VectorXd> motion;
  motion.reserve(p_HF.size());
  for (const KnownTips& tips : p_HF) {
    motion.push_back(
        SolveHandIk(hand, tips, motion.empty() ? Eigen::VectorXd() : motion.back(), options).q);
  }
  return motion;
}

HandPoseIkResult SolveHandPoseIk(const HumanHand& hand, const KnownTips& p_WF,
                                 const Pose& X_WH_prior, const Eigen::VectorXd& previous,
                                 const HandIkOptions& options) {
  // Unknowns: t, w of X_WH = X_prior (t, exp w), then all joints.
  const int n = hand.tree.num_joints();
  const bool warm = previous.size() == n;
  const Eigen::VectorXd held = warm ? previous : Eigen::VectorXd();
  const Pose X_prior_inverse = X_WH_prior.inverse();
  std::vector<PostureRows> posture;
  int rows = 6;
  for (int f = 0; f < kNumFingers; ++f) {
    posture.emplace_back(hand, f, held, options);
    rows += posture.back().count() + (p_WF[f] ? 3 : 0);
  }
  std::vector<Pose> X_HB;
  Eigen::VectorXd q(n);
  Eigen::MatrixXd J_full(6, n), J_finger(rows, n);
  LeastSquaresProblem problem;
  problem.num_residuals = rows;
  problem.lower = Eigen::VectorXd::Constant(6 + n, -3);
  problem.upper = Eigen::VectorXd::Constant(6 + n, 3);
  problem.lower.tail(n) = hand.tree.lower;
  problem.upper.tail(n) = hand.tree.upper;
  problem.evaluate = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    q = x.tail(n);
    ForwardKinematics(hand.tree, q, X_HB);
    const Eigen::Vector3d t = x.head<3>(), w = x.segment<3>(3);
    const Eigen::Matrix3d R = ExpRotation(w).toRotationMatrix();
    const Eigen::Matrix3d Jr = RightJacobian(w);
    r.head<3>() = t / options.wrist_deviation;
    r.segment<3>(3) = w / options.turn_deviation;
    if (J != nullptr) {
      J->setZero();
      J->block<3, 3>(0, 0).diagonal().setConstant(1 / options.wrist_deviation);
      J->block<3, 3>(3, 3).diagonal().setConstant(1 / options.turn_deviation);
    }
    int row = 6;
    for (int f = 0; f < kNumFingers; ++f) {
      if (p_WF[f]) {
        const Eigen::Vector3d p_HF = FramePose(hand.tree, X_HB, hand.tip[f]).translation();
        r.segment<3>(row) = (t + R * p_HF - X_prior_inverse * *p_WF[f]) / options.tip_deviation;
        if (J != nullptr) {
          FrameJacobian(hand.tree, X_HB, hand.tip[f], J_full);
          J->block<3, 3>(row, 0).diagonal().setConstant(1 / options.tip_deviation);
          J->block<3, 3>(row, 3) = -R * Cross(p_HF) * Jr / options.tip_deviation;
          J->block(row, 6, 3, n) = R * J_full.topRows<3>() / options.tip_deviation;
        }
        row += 3;
      }
      if (J == nullptr) {
        posture[f].Fill(q, 0, row, r, nullptr);
      } else {
        // The finger's joints are not contiguous in q: fill aside, then scatter.
        J_finger.setZero();
        posture[f].Fill(q, 0, row, r, &J_finger);
        for (std::size_t i = 0; i < hand.joints[f].size(); ++i) {
          J->block(row, 6 + hand.joints[f][i], posture[f].count(), 1) =
              J_finger.block(row, static_cast<Eigen::Index>(i), posture[f].count(), 1);
        }
      }
      row += posture[f].count();
    }
  };
  Eigen::VectorXd x = Eigen::VectorXd::Zero(6 + n);
  x.tail(n) = warm ? previous : hand.rest;
  LevenbergMarquardtOptions solver = SolverOptions(options);
  solver.max_iterations = 2 * options.max_iterations;
  const LevenbergMarquardtResult solution = MinimizeLeastSquares(problem, x, solver);
  HandPoseIkResult result;
  result.q = solution.x.tail(n);
  result.X_WH = X_WH_prior * MakePose(solution.x.head<3>(), ExpRotation(solution.x.segment<3>(3)));
  result.error = TipErrors(hand, result.q, result.X_WH, p_WF);
  return result;
}

Pose PriorHandPose(const HumanHand& hand, const KnownTips& p_WF, const Eigen::Vector3d& up_W) {
  std::vector<int> known;
  for (int f = 0; f < kNumFingers; ++f) {
    if (p_WF[f]) known.push_back(f);
  }
  ThrowUnless(known.size() >= 2, "a hand pose needs at least two known fingertips, found {}",
              known.size());
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, hand.rest, X_HB);
  const auto tip_H = [&](int f) {
    return Eigen::Vector3d(FramePose(hand.tree, X_HB, hand.tip[f]).translation());
  };
  const Eigen::Vector3d line_H = tip_H(known[1]) - tip_H(known[0]);
  const Eigen::Vector3d line_W = *p_WF[known[1]] - *p_WF[known[0]];
  const Eigen::Vector3d safe_W = line_W.norm() > 1e-6 ? line_W : Eigen::Vector3d::UnitX();
  Eigen::Vector3d hint = up_W;
  if (hint.cross(safe_W).norm() < 1e-3 * hint.norm() * safe_W.norm())
    hint = safe_W.unitOrthogonal();
  const Eigen::Matrix3d R_WH =
      FrameFromXZ(safe_W, hint) * FrameFromXZ(line_H, Eigen::Vector3d::UnitZ()).transpose();
  Pose X_WH = Pose::Identity();
  X_WH.linear() = R_WH;
  X_WH.translation() = 0.5 * (*p_WF[known[0]] + *p_WF[known[1]]) -
                       R_WH * (0.5 * (tip_H(known[0]) + tip_H(known[1])));
  return X_WH;
}

}  // namespace springgrasp
