// Minimum-jerk segments, completion to rest, movement time.
#include "motion/minimum_jerk.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "motion/dmp.h"
#include "motion/movement_time.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

MotionState RandomState(RandomEngine& engine) {
  MotionState state = {VectorXd(3), VectorXd(3), VectorXd(3)};
  for (VectorXd* part : {&state.x, &state.v, &state.a}) {
    for (double& value : *part) value = Uniform(engine, -1, 1);
  }
  return state;
}

void ExpectEqual(const MotionState& a, const MotionState& b) {
  EXPECT_LT((a.x - b.x).norm(), 1e-9);
  EXPECT_LT((a.v - b.v).norm(), 1e-9);
  EXPECT_LT((a.a - b.a).norm(), 1e-8);
}

MotionSamples Bell(double T) {
  MotionSamples out;
  out.t = EvenTimes(T, 0.01);
  out.x.resize(out.t.size(), 3);
  out.v = out.a = out.x;
  const VectorXd zero = VectorXd::Zero(3);
  const MinimumJerk line =
      MakeMinimumJerk({zero, zero, zero}, {Eigen::Vector3d(0.3, 0.1, 0), zero, zero}, T);
  for (Index i = 0; i < out.t.size(); ++i) {
    const MotionState state = EvaluateMinimumJerk(line, out.t[i]);
    out.x.row(i) = state.x.transpose();
    out.v.row(i) = state.v.transpose();
    out.a.row(i) = state.a.transpose();
  }
  return out;
}

MotionSamples Cut(const MotionSamples& samples, Index first, Index count) {
  return {samples.t.segment(first, count), samples.x.middleRows(first, count),
          samples.v.middleRows(first, count), samples.a.middleRows(first, count)};
}

TEST(MinimumJerk, MeetsBothStates) {
  RandomEngine engine = MakeStream(1, 0, "ends");
  for (int draw = 0; draw < 20; ++draw) {
    const MotionState start = RandomState(engine), end = RandomState(engine);
    const double T = Uniform(engine, 0.2, 2);
    const MinimumJerk segment = MakeMinimumJerk(start, end, T);
    ExpectEqual(EvaluateMinimumJerk(segment, 0), start);
    ExpectEqual(EvaluateMinimumJerk(segment, T), end);
  }
}

TEST(MinimumJerk, StopFromNeedsNoMoreJerkThanNeighbouringPlaces) {
  RandomEngine engine = MakeStream(2, 0, "stop");
  const auto jerk = [](const MinimumJerk& segment) {
    double sum = 0;
    for (double t = 5e-4; t < segment.T; t += 1e-3) {
      const auto& c = segment.coefficients;
      sum += (6 * c.col(3) + 24 * t * c.col(4) + 60 * t * t * c.col(5)).squaredNorm() * 1e-3;
    }
    return sum;
  };
  for (int draw = 0; draw < 10; ++draw) {
    const MotionState state = RandomState(engine);
    const MinimumJerk stop = StopFrom(state, 0.5);
    const MotionState rest = EvaluateMinimumJerk(stop, 0.5);
    EXPECT_LT(rest.v.norm() + rest.a.norm(), 1e-8);
    ExpectEqual(EvaluateMinimumJerk(stop, 0), state);
    for (int axis = 0; axis < 3; ++axis) {
      MotionState other = rest;
      other.x[axis] += 0.02;
      EXPECT_GT(jerk(MakeMinimumJerk(state, other, 0.5)), jerk(stop));
      other.x[axis] -= 0.04;
      EXPECT_GT(jerk(MakeMinimumJerk(state, other, 0.5)), jerk(stop));
    }
  }
}

TEST(CompleteToRest, RestoresAReachThatWasCutAtPeakSpeed) {
  const MotionSamples bell = Bell(1.0);
  const CompletedMotion out = CompleteToRest(Cut(bell, 50, 51));
  EXPECT_NEAR(out.begin, 0.5, 0.1);
  EXPECT_EQ(out.end, 0);
  EXPECT_LT(out.samples.v.row(0).norm() + out.samples.a.row(0).norm(), 1e-8);
  // Half of a bell is restored to a few centimetres of its 0.32 m.
  EXPECT_LT((out.samples.x.row(0) - bell.x.row(0)).norm(), 0.05);
}

TEST(CompleteToRest, IsContinuousAndLeavesTheRecordingAlone) {
  const MotionSamples cut = Cut(Bell(1.0), 30, 50);
  const CompletedMotion out = CompleteToRest(cut);
  EXPECT_GT(out.begin, 0.1);
  EXPECT_GT(out.end, 0.1);
  const auto before = static_cast<Index>(std::lround(out.begin / 0.01));
  EXPECT_EQ(out.samples.x.middleRows(before, 50), cut.x);
  for (Index i = 1; i < out.samples.size(); ++i) {
    const double dt = out.samples.t[i] - out.samples.t[i - 1];
    EXPECT_NEAR(dt, 0.01, 1e-9);
    EXPECT_LT((out.samples.v.row(i) - out.samples.v.row(i - 1)).norm(), 0.05);
    EXPECT_LT((out.samples.a.row(i) - out.samples.a.row(i - 1)).norm(), 0.5);
  }
  EXPECT_LT(out.samples.v.bottomRows(1).norm(), 1e-8);
}

TEST(CompleteToRest, AddsNothingToAWholeMovement) {
  const MotionSamples bell = Bell(1.0);
  const CompletedMotion out = CompleteToRest(bell);
  EXPECT_EQ(out.begin, 0);
  EXPECT_EQ(out.end, 0);
  EXPECT_EQ(out.samples.x, bell.x);
}

TEST(MovementTime, RunsFromFirstToLastFivePercentOfPeakSpeed) {
  const MotionSamples bell = Bell(1.0);
  const MovementTime time = FindMovementTime(bell.t, bell.v);
  // 16 s^2 (1-s)^2 = 0.05
  const double s = 0.5 * (1 - std::sqrt(1 - std::sqrt(0.05)));
  EXPECT_NEAR(time.begin, s, 1e-3);
  EXPECT_NEAR(time.end, 1 - s, 1e-3);
  EXPECT_NEAR(time.t_peak, 0.5, 1e-9);
  EXPECT_NEAR(time.peak_speed, 1.875 * std::sqrt(0.1), 1e-9);
  EXPECT_FALSE(time.cut_at_begin || time.cut_at_end);
  const MotionSamples cut = Cut(bell, 50, 51);
  EXPECT_TRUE(FindMovementTime(cut.t, cut.v).cut_at_begin);
}

TEST(MinimumJerk, BellHasItsKnownPeak) {
  EXPECT_DOUBLE_EQ(MinimumJerkSpeed(0.5), 1.875);
  EXPECT_DOUBLE_EQ(MinimumJerkPosition(0.5), 0.5);
  EXPECT_EQ(MinimumJerkPosition(2), 1);
}

}  // namespace
}  // namespace springgrasp
