#include "experiment/closing_plan.h"

#include <algorithm>
#include <cmath>

#include "kinematics/power_posture.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

// Fractions of T.
constexpr double kClosed = 1.3;
constexpr double kLate = 1.25, kLateClosed = 1.5;
constexpr double kMaxEarlyFlexion = 0.25;  // rad

// Sample of the widest aperture within the part of the reach where humans have it.
std::size_t Widest(const HandMotionResult& motion, const PerFinger<bool>& involved, double dt,
                   double T) {
  const auto at = [&](double t) {
    return std::min(motion.q.size() - 1, static_cast<std::size_t>(std::lround(t / dt)));
  };
  std::size_t widest = at(0.3 * T);
  double aperture = -1;
  for (std::size_t i = at(0.3 * T); i <= at(0.75 * T); ++i) {
    double sum = 0;
    for (int f = kIndex; f < kNumFingers; ++f) {
      if (involved[f]) sum += (motion.p_HF[i][f] - motion.p_HF[i][kThumb]).norm();
    }
    if (sum <= aperture) continue;
    aperture = sum;
    widest = i;
  }
  return widest;
}

// Both joints of a finger on one valve turn alike until the first has come to `stop`.
void TurnAlike(const RobotHand::Finger& finger, double stop, Eigen::VectorXd& q) {
  const double mean = 0.5 * (q[finger.j0] + q[finger.j1]);
  q[finger.j0] = std::min(mean, stop);
  q[finger.j1] = 2 * mean - q[finger.j0];
}

}  // namespace

std::vector<Eigen::VectorXd> CloseAfterArrival(
    const RobotHand& hand, const HandMotionResult& motion, const PerFinger<bool>& involved,
    const Eigen::VectorXd& q_wait, const Eigen::VectorXd& q_contact, double dt, double T) {
  const std::size_t widest = Widest(motion, involved, dt, T);
  // Uninvolved fingers and the palm are in place when the hand arrives.
  Eigen::VectorXd q_arrive = q_contact;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!involved[f]) continue;
    for (const int j : {hand.fingers[f].j0, hand.fingers[f].j1}) {
      q_arrive[j] = std::min(motion.q[widest][j], q_wait[j]);
    }
  }
  // Thumb and fingers of this hand cross when they curl together: before the arrival none flexes
  // much more than it will have to.
  std::vector<Eigen::VectorXd> q = motion.q;
  for (Eigen::VectorXd& posture : q) {
    posture = posture.cwiseMin((q_arrive.array() + kMaxEarlyFlexion).matrix());
  }
  const std::vector<Eigen::VectorXd> human_like = q;
  const double t_widest = static_cast<double>(widest) * dt;
  const auto between = [&](double t, double from, double to) {
    return MinimumJerkPosition(std::clamp((t - from) / (to - from), 0.0, 1.0));
  };
  for (std::size_t i = 0; i < q.size(); ++i) {
    const double t = static_cast<double>(i) * dt;
    // Leaves the human-like motion for the waiting posture from before the widest aperture on.
    const double wait = between(t, 0.5 * t_widest, 0.9 * T);
    q[i] = (1 - wait) * human_like[std::min(i, widest)] + wait * q_arrive;
    q[i] += between(t, T, kClosed * T) * (q_contact - q_arrive);
    for (int f = 0; f < kNumFingers; ++f) {
      if (!involved[f] || !OnOneValve(hand, f)) continue;
      const RobotHand::Finger& finger = hand.fingers[f];
      for (const int j : {finger.j0, finger.j1}) {
        if (t <= T || f == kThumb) continue;
        q[i][j] =
            q_arrive[j] + between(t, kLate * T, kLateClosed * T) * (q_contact[j] - q_arrive[j]);
      }
      // The object stops it only once the hand is there.
      TurnAlike(finger, t > T ? q_contact[finger.j0] : hand.tree.upper[finger.j0], q[i]);
    }
  }
  return q;
}

}  // namespace springgrasp
