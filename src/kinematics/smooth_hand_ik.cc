#include "kinematics/smooth_hand_ik.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

constexpr int kMost = 5;  // joints of a finger

using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
using Part = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;

// H d = g for a symmetric matrix of blocks with two bands below the diagonal: block k couples to
// k - 1 by low1[k] and to k - 2 by low2[k]. Overwrites all with the factor L D L' and the solution.
void SolveBanded(std::vector<Block>& diagonal, std::vector<Block>& low1, std::vector<Block>& low2,
                 std::vector<Part>& g) {
  const int n = static_cast<int>(g.size());
  std::vector<Eigen::LLT<Block>> factor(n);
  // low1, low2 hold H_(k,k-1), H_(k,k-2), then the same less what was eliminated.
  for (int k = 0; k < n; ++k) {
    if (k > 1) {
      const Block a = factor[k - 2].solve(low2[k].transpose());
      diagonal[k] -= low2[k] * a;
      low1[k] -= low2[k] * factor[k - 2].solve(low1[k - 1].transpose());
      g[k] -= low2[k] * factor[k - 2].solve(g[k - 2]);
    }
    if (k > 0) {
      diagonal[k] -= low1[k] * factor[k - 1].solve(low1[k].transpose());
      g[k] -= low1[k] * factor[k - 1].solve(g[k - 1]);
    }
    factor[k].compute(diagonal[k]);
  }
  for (int k = n - 1; k >= 0; --k) {
    if (k + 1 < n) g[k] -= low1[k + 1].transpose() * g[k + 1];
    if (k + 2 < n) g[k] -= low2[k + 2].transpose() * g[k + 2];
    g[k] = factor[k].solve(g[k]);
  }
}

class FingerMotion {
 public:
  FingerMotion(const HumanHand& hand, int finger, const std::vector<KnownTips>& p_HF,
               const SmoothHandOptions& options, std::vector<Eigen::VectorXd>& motion)
      : hand_(hand),
        finger_(finger),
        joints_(hand.joints[finger]),
        n_(static_cast<int>(joints_.size())),
        count_(static_cast<int>(motion.size())),
        p_HF_(p_HF),
        options_(options),
        motion_(motion),
        J_full_(6, hand.tree.num_joints()) {
    const double step = options.speed_deviation * options.dt;
    const double bend = options.acceleration_deviation * options.dt * options.dt;
    speed_ = 1 / (step * step);
    bend_ = 1 / (bend * bend);
  }

  void Solve() {
    double damping = 1e-4;
    double cost = Cost(motion_);
    std::vector<Eigen::VectorXd> trial = motion_;
    for (int i = 0; i < options_.max_iterations; ++i) {
      Fill(damping);
      SolveBanded(diagonal_, low1_, low2_, gradient_);
      double largest = 0;
      for (int k = 0; k < count_; ++k) {
        for (int j = 0; j < n_; ++j) {
          const int joint = joints_[j];
          const double q = std::clamp(motion_[k][joint] - gradient_[k][j], hand_.tree.lower[joint],
                                      hand_.tree.upper[joint]);
          largest = std::max(largest, std::abs(q - motion_[k][joint]));
          trial[k][joint] = q;
        }
      }
      const double found = Cost(trial);
      if (found < cost) {
        for (int k = 0; k < count_; ++k) {
          for (const int joint : joints_) motion_[k][joint] = trial[k][joint];
        }
        damping = std::max(1e-8, damping / 4);
        const bool small = cost - found < 1e-6 * cost;
        cost = found;
        if (small || largest < 1e-5) break;
      } else {
        damping = std::max(damping, 1e-6) * 8;
      }
    }
  }

 private:
  Eigen::Vector3d TipError(const Eigen::VectorXd& q, int k) {
    ForwardKinematics(hand_.tree, q, X_HB_);
    return FramePose(hand_.tree, X_HB_, hand_.tip[finger_]).translation() - *p_HF_[k][finger_];
  }

  // Of a joint's distance from rest.
  double RestWeight(int j) const {
    const bool abduction = finger_ != kThumb && j == n_ - 4;
    const double deviation =
        abduction ? options_.ik.abduction_deviation : options_.ik.rest_deviation;
    return 1 / (deviation * deviation);
  }

  double LinkWeight() const {
    return finger_ == kThumb
               ? 0
               : 1 / (options_.ik.coupling_deviation * options_.ik.coupling_deviation);
  }

  double Cost(const std::vector<Eigen::VectorXd>& motion) {
    double cost = 0;
    const double tip = options_.ik.tip_deviation, far = options_.outlier;
    for (int k = 0; k < count_; ++k) {
      const Eigen::VectorXd& q = motion[k];
      if (p_HF_[k][finger_]) {
        const double e = TipError(q, k).norm();
        cost += (e < far ? e * e : far * (2 * e - far)) / (tip * tip);
      }
      for (int j = 0; j < n_; ++j) {
        const int joint = joints_[j];
        const double off = q[joint] - hand_.rest[joint];
        cost += RestWeight(j) * off * off;
        if (k == 0) continue;
        const double step = q[joint] - motion[k - 1][joint];
        cost += speed_ * step * step;
        if (k == 1) continue;
        const double bend = step - motion[k - 1][joint] + motion[k - 2][joint];
        cost += bend_ * bend * bend;
      }
      const double link = q[joints_[n_ - 1]] - 2.0 / 3 * q[joints_[n_ - 2]];
      cost += LinkWeight() * link * link;
    }
    return cost;
  }

  // Half the cost's Gauss-Newton matrix and gradient; joints that press against their range are
  // held.
  void Fill(double damping) {
    const Block zero = Block::Zero(n_, n_), one = Block::Identity(n_, n_);
    diagonal_.assign(count_, zero);
    low1_.assign(count_, zero);
    low2_.assign(count_, zero);
    gradient_.assign(count_, Part::Zero(n_));
    const auto at = [&](int k) {
      Part q(n_);
      for (int j = 0; j < n_; ++j) q[j] = motion_[k][joints_[j]];
      return q;
    };
    for (int k = 0; k < count_; ++k) {
      const Eigen::VectorXd& full = motion_[k];
      if (p_HF_[k][finger_]) {
        const Eigen::Vector3d e = TipError(full, k);
        FrameJacobian(hand_.tree, X_HB_, hand_.tip[finger_], J_full_);
        Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMost> J(3, n_);
        for (int j = 0; j < n_; ++j) J.col(j) = J_full_.col(joints_[j]).head<3>();
        const double tip = options_.ik.tip_deviation;
        const double weight =
            std::min(1.0, options_.outlier / std::max(1e-9, e.norm())) / (tip * tip);
        diagonal_[k] += weight * J.transpose() * J;
        gradient_[k] += weight * J.transpose() * e;
      }
      for (int j = 0; j < n_; ++j) {
        const int joint = joints_[j];
        diagonal_[k](j, j) += RestWeight(j);
        gradient_[k][j] += RestWeight(j) * (full[joint] - hand_.rest[joint]);
      }
      if (const double w = LinkWeight(); w > 0) {
        const int a = n_ - 1, b = n_ - 2;
        const double r = full[joints_[a]] - 2.0 / 3 * full[joints_[b]];
        gradient_[k][a] += w * r;
        gradient_[k][b] -= 2.0 / 3 * w * r;
        diagonal_[k](a, a) += w;
        diagonal_[k](b, b) += 4.0 / 9 * w;
        diagonal_[k](a, b) -= 2.0 / 3 * w;
        diagonal_[k](b, a) -= 2.0 / 3 * w;
      }
      if (k > 0) {
        const Part step = at(k) - at(k - 1);
        gradient_[k] += speed_ * step;
        gradient_[k - 1] -= speed_ * step;
        diagonal_[k] += speed_ * one;
        diagonal_[k - 1] += speed_ * one;
        low1_[k] -= speed_ * one;
      }
      if (k > 1) {
        const Part bend = at(k) - 2 * at(k - 1) + at(k - 2);
        gradient_[k] += bend_ * bend;
        gradient_[k - 1] -= 2 * bend_ * bend;
        gradient_[k - 2] += bend_ * bend;
        diagonal_[k] += bend_ * one;
        diagonal_[k - 1] += 4 * bend_ * one;
        diagonal_[k - 2] += bend_ * one;
        low1_[k] -= 2 * bend_ * one;
        low1_[k - 1] -= 2 * bend_ * one;
        low2_[k] += bend_ * one;
      }
    }
    for (int k = 0; k < count_; ++k) {
      for (int j = 0; j < n_; ++j) {
        diagonal_[k](j, j) *= 1 + damping;
        const int joint = joints_[j];
        const double q = motion_[k][joint], slope = gradient_[k][j];
        const bool held = (q <= hand_.tree.lower[joint] && slope > 0) ||
                          (q >= hand_.tree.upper[joint] && slope < 0);
        if (!held) continue;
        gradient_[k][j] = 0;
        diagonal_[k].row(j).setZero();
        diagonal_[k].col(j).setZero();
        diagonal_[k](j, j) = 1;
        low1_[k].row(j).setZero();
        low2_[k].row(j).setZero();
        if (k + 1 < count_) low1_[k + 1].col(j).setZero();
        if (k + 2 < count_) low2_[k + 2].col(j).setZero();
      }
    }
  }

  const HumanHand& hand_;
  const int finger_;
  const std::vector<int>& joints_;
  const int n_, count_;
  const std::vector<KnownTips>& p_HF_;
  const SmoothHandOptions& options_;
  std::vector<Eigen::VectorXd>& motion_;
  double speed_ = 0, bend_ = 0;
  Eigen::MatrixXd J_full_;
  std::vector<Pose> X_HB_;
  std::vector<Block> diagonal_, low1_, low2_;
  std::vector<Part> gradient_;
};

}  // namespace

std::vector<Eigen::VectorXd> SolveHandMotionSmoothly(const HumanHand& hand,
                                                     const std::vector<KnownTips>& p_HF,
                                                     const SmoothHandOptions& options) {
  ThrowUnless(options.dt > 0, "a hand motion needs a positive step");
  std::vector<Eigen::VectorXd> motion = SolveHandMotion(hand, p_HF, options.ik);
  for (int f = 0; f < kNumFingers; ++f) {
    // A finger that was never seen rests.
    const bool seen = std::any_of(p_HF.begin(), p_HF.end(),
                                  [f](const KnownTips& tips) { return tips[f].has_value(); });
    if (seen) FingerMotion(hand, f, p_HF, options, motion).Solve();
  }
  return motion;
}

}  // namespace springgrasp
