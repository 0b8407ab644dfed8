#include "demonstration/hand_motion.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

// Minimum jerk from rest at -c to 0 with end velocity 1 (per unit of s) and no end acceleration.
// The wind-up of the first part keeps the way short where the movement begins fast.
double RunUp(double s) {
  constexpr double kDistance = 0.25;
  const double s3 = s * s * s;
  return -kDistance * (1 - MinimumJerkPosition(s)) + s3 * (-4 + s * (7 - 3 * s));
}

}  // namespace

HandMotion Moved(const HandMotion& motion, const Pose& X_VW) {
  HandMotion moved = motion;
  for (HandMotionSample& sample : moved.samples) sample.X_WH = X_VW * sample.X_WH;
  if (moved.object) moved.object->X_WO = X_VW * moved.object->X_WO;
  moved.up = X_VW.linear() * motion.up;
  return moved;
}

HandMotionSample Interpolated(const HandMotion& motion, double t) {
  const auto& samples = motion.samples;
  ThrowUnless(!samples.empty(), "{}: a hand motion without samples", motion.source);
  const auto after = std::upper_bound(samples.begin(), samples.end(), t,
                                      [](double time, const auto& s) { return time < s.t; });
  HandMotionSample result;
  if (after == samples.begin() || after == samples.end()) {
    result = after == samples.begin() ? samples.front() : samples.back();
    result.t = t;
    return result;
  }
  const HandMotionSample& a = *(after - 1);
  const HandMotionSample& b = *after;
  const double w = (t - a.t) / (b.t - a.t);
  result = w < 0.5 ? a : b;
  result.t = t;
  result.q = (1 - w) * a.q + w * b.q;
  result.X_WH = Interpolate(a.X_WH, b.X_WH, w);
  if (w > 1e-9) {
    result.wrist_recorded = a.wrist_recorded && b.wrist_recorded;
    for (int f = 0; f < kNumFingers; ++f) result.recorded[f] = a.recorded[f] && b.recorded[f];
  }
  return result;
}

HandMotion Resampled(const HandMotion& motion, double rate) {
  HandMotion even = motion;
  even.samples.clear();
  constexpr double kSlack = 1e-9;  // s, for rounded times
  const int first = static_cast<int>(std::ceil(motion.samples.front().t * rate - kSlack));
  const int last = static_cast<int>(std::floor(motion.samples.back().t * rate + kSlack));
  for (int i = first; i <= last; ++i) even.samples.push_back(Interpolated(motion, i / rate));
  return even;
}

HandMotion AtPeakSpeed(const HandMotion& motion, double speed) {
  constexpr double kWindow = 0.03;  // s
  double peak = 0;
  for (const HandMotionSample& sample : motion.samples) {
    const Pose a = Interpolated(motion, sample.t).X_WH;
    const Pose b = Interpolated(motion, sample.t + kWindow).X_WH;
    peak = std::max(peak, (b.translation() - a.translation()).norm() / kWindow);
  }
  ThrowUnless(peak > 1e-3, "{}: the wrist stands still, so that it cannot be moved at {} m/s",
              motion.source, speed);
  HandMotion paced = motion;
  for (HandMotionSample& sample : paced.samples) sample.t *= peak / speed;
  return paced;
}

HandMotion WithLeadIn(const HandMotion& motion, const Eigen::VectorXd& q_open, double duration,
                      double rate) {
  ThrowUnless(motion.samples.size() >= 2, "{}: a hand motion without movement", motion.source);
  // Velocities over the first 30 ms: short against the movement, long against recording noise.
  const HandMotionSample& first = motion.samples.front();
  const HandMotionSample next = Interpolated(motion, first.t + 0.03);
  const Eigen::Quaterniond R0(first.X_WH.linear());
  const Eigen::Vector3d v = (next.X_WH.translation() - first.X_WH.translation()) / 0.03;
  const Eigen::Vector3d w =
      LogRotation(R0.conjugate() * Eigen::Quaterniond(next.X_WH.linear())) / 0.03;
  const Eigen::VectorXd q_dot = (next.q - first.q) / 0.03;
  HandMotion longer = motion;
  longer.samples.clear();
  const int steps = static_cast<int>(std::lround(duration * rate));
  for (int i = 0; i < steps; ++i) {
    const double s = double(i) / steps;
    const double run_up = duration * RunUp(s);
    HandMotionSample sample;
    sample.t = first.t - duration * (1 - s);
    sample.X_WH = MakePose(first.X_WH.translation() + v * run_up, R0 * ExpRotation(w * run_up));
    // The fingers start from the open hand itself: their run-up has no offset.
    const double blend = MinimumJerkPosition(s);
    const double s3 = s * s * s;
    sample.q =
        q_open + blend * (first.q - q_open) + q_dot * (duration * s3 * (-4 + s * (7 - 3 * s)));
    longer.samples.push_back(sample);
  }
  longer.samples.insert(longer.samples.end(), motion.samples.begin(), motion.samples.end());
  return longer;
}

}  // namespace springgrasp
