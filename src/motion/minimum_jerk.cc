#include "motion/minimum_jerk.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "motion/movement_time.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Phase (0 to 0.5) at which a rest-to-rest minimum-jerk movement has this part of its peak speed.
double BellPhase(double speed_ratio) {
  return 0.5 * (1 - std::sqrt(1 - std::sqrt(std::clamp(speed_ratio, 0.0, 1.0))));
}

MotionState StateAt(const MotionSamples& samples, Index i) {
  return {samples.x.row(i).transpose(), samples.v.row(i).transpose(), samples.a.row(i).transpose()};
}

MotionState Reversed(MotionState state) {
  state.v = -state.v;
  return state;
}

double MedianStep(const VectorXd& t) {
  std::vector<double> steps;
  for (Index i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

}  // namespace

MinimumJerk MakeMinimumJerk(const MotionState& start, const MotionState& end, double T) {
  ThrowUnless(T > 0, "minimum jerk: duration is {} s, must be positive", T);
  const VectorXd D = end.x - start.x - T * start.v - 0.5 * T * T * start.a;
  const VectorXd V = (end.v - start.v - T * start.a) * T;
  const VectorXd A = (end.a - start.a) * (T * T);
  MinimumJerk out;
  out.T = T;
  out.coefficients.resize(start.x.size(), 6);
  out.coefficients.col(0) = start.x;
  out.coefficients.col(1) = start.v;
  out.coefficients.col(2) = 0.5 * start.a;
  out.coefficients.col(3) = (10 * D - 4 * V + 0.5 * A) / std::pow(T, 3);
  out.coefficients.col(4) = (-15 * D + 7 * V - A) / std::pow(T, 4);
  out.coefficients.col(5) = (6 * D - 3 * V + 0.5 * A) / std::pow(T, 5);
  return out;
}

MotionState EvaluateMinimumJerk(const MinimumJerk& segment, double t) {
  t = std::clamp(t, 0.0, segment.T);
  const MatrixXd& c = segment.coefficients;
  MotionState out;
  out.x =
      c.col(0) + t * (c.col(1) + t * (c.col(2) + t * (c.col(3) + t * (c.col(4) + t * c.col(5)))));
  out.v =
      c.col(1) + t * (2 * c.col(2) + t * (3 * c.col(3) + t * (4 * c.col(4) + t * 5 * c.col(5))));
  out.a = 2 * c.col(2) + t * (6 * c.col(3) + t * (12 * c.col(4) + t * 20 * c.col(5)));
  return out;
}

double MinimumJerkPosition(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 - s * (15 - 6 * s));
}

double MinimumJerkSpeed(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return 30 * s * s * (1 - s) * (1 - s);
}

MinimumJerk StopFrom(const MotionState& state, double T) {
  // With the place of rest free its costate is zero: in time to go r the movement is
  // x_end + c3 r^3 + c4 r^4.
  const VectorXd c4 = (0.5 * T * state.a + state.v) / (2 * T * T * T);
  const VectorXd c3 = (state.a - 12 * T * T * c4) / (6 * T);
  const VectorXd zero = VectorXd::Zero(state.x.size());
  const MotionState rest = {state.x - T * T * T * c3 - T * T * T * T * c4, zero, zero};
  return MakeMinimumJerk(state, rest, T);
}

CompletedMotion CompleteToRest(const MotionSamples& samples, int columns, double min_time) {
  const Index m = samples.size();
  ThrowUnless(m >= 2 && columns >= 1 && columns <= samples.dimension() && samples.x.rows() == m &&
                  samples.v.rows() == m && samples.a.rows() == m,
              "completing a movement: {} samples of {} coordinates, {} of them for speed", m,
              samples.dimension(), columns);
  const MovementTime time = FindMovementTime(samples.t, samples.v.leftCols(columns));
  const auto ratio = [&](Index i) {
    return samples.v.row(i).head(columns).norm() / std::max(time.peak_speed, 1e-12);
  };
  const double phase0 = time.cut_at_begin ? BellPhase(ratio(0)) : 0;
  const double phase1 = time.cut_at_end ? BellPhase(ratio(m - 1)) : 0;
  // Cut on both sides near the peak the bell is not determined: at most four times what was seen.
  const double bell = time.duration() / std::max(1 - phase0 - phase1, 0.25);
  const double dt = MedianStep(samples.t);
  const auto added = [&](bool cut, double phase) {
    return cut ? static_cast<Index>(std::ceil(std::max(min_time, phase * bell) / dt)) : Index{0};
  };
  const Index before = added(time.cut_at_begin, phase0);
  const Index after = added(time.cut_at_end, phase1);
  CompletedMotion out;
  out.begin = static_cast<double>(before) * dt;
  out.end = static_cast<double>(after) * dt;
  const Index total = before + m + after;
  out.samples.t.resize(total);
  for (MatrixXd* values : {&out.samples.x, &out.samples.v, &out.samples.a}) {
    values->resize(total, samples.dimension());
  }
  const auto put = [&](Index row, double t, const MotionState& state) {
    out.samples.t[row] = t;
    out.samples.x.row(row) = state.x.transpose();
    out.samples.v.row(row) = state.v.transpose();
    out.samples.a.row(row) = state.a.transpose();
  };
  if (before > 0) {
    // Starting is stopping with time reversed.
    const MinimumJerk start = StopFrom(Reversed(StateAt(samples, 0)), out.begin);
    for (Index i = 0; i < before; ++i) {
      const double t = static_cast<double>(i) * dt;
      put(i, t, Reversed(EvaluateMinimumJerk(start, out.begin - t)));
    }
  }
  for (Index i = 0; i < m; ++i) {
    put(before + i, samples.t[i] - samples.t[0] + out.begin, StateAt(samples, i));
  }
  if (after > 0) {
    const MinimumJerk stop = StopFrom(StateAt(samples, m - 1), out.end);
    const double t0 = out.samples.t[before + m - 1];
    for (Index i = 1; i <= after; ++i) {
      const double t = static_cast<double>(i) * dt;
      put(before + m - 1 + i, t0 + t, EvaluateMinimumJerk(stop, t));
    }
  }
  return out;
}

}  // namespace springgrasp
