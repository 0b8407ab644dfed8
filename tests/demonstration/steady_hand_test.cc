// A hand pose that agrees with the fingertips.
#include "demonstration/steady_hand.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/pose.h"
#include "base/random.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr PerFinger<bool> kPinch = {true, true, false, false, false};
constexpr double kStill = 0.2, kMoves = 1.0, kHeld = 0.4;  // s

const PerFinger<Vector3d> kTips = {Vector3d(0.08, 0.05, -0.03), Vector3d(0.15, 0.02, -0.05),
                                   Vector3d(0.16, 0, -0.055), Vector3d(0.15, -0.02, -0.05),
                                   Vector3d(0.125, -0.04, -0.04)};

// A reach of 0.3 m and 0.4 rad on which thumb and index open and close; the other fingers rest in
// the hand.
struct Reach {
  Demonstration truth, seen;
};

Pose HandAt(double t) {
  const double m = MinimumJerkPosition(std::clamp((t - kStill) / kMoves, 0.0, 1.0));
  return MakePose(Vector3d(0.3 * m, 0.5, 1 + 0.05 * m), ExpRotation(Vector3d(0, 0.4 * m, 0.2)));
}

Vector3d TipInHand(int finger, double t) {
  const double s = std::clamp((t - kStill) / kMoves, 0.0, 1.0);
  const double open = 0.03 * std::pow(std::sin(M_PI * s), 2);
  if (finger == kThumb) return kTips[finger] + open * Vector3d(-0.5, 0.5, -0.7);
  return finger == kIndex ? Vector3d(kTips[finger] + open * Vector3d(1, 0, 0.3)) : kTips[finger];
}

// The hand is seen with an error that wanders by `error` (m, and rad / 0.07 m), the tips with
// `noise`.
Reach Show(double error, double noise, RandomEngine& engine) {
  Reach reach;
  PerFinger<double> phase;
  for (double& p : phase) p = Uniform(engine, 0, 2 * M_PI);
  for (double t = 0; t < kStill + kMoves + kHeld; t += 1.0 / 30) {
    DemonstrationSample sample;
    sample.t = t;
    const Pose X_WH = HandAt(t);
    sample.p_WH = X_WH.translation();
    sample.R_WH = Quaterniond(X_WH.linear());
    for (int i = 0; i < kNumFingers; ++i) sample.p_WF[i] = X_WH * TipInHand(i, t);
    reach.truth.samples.push_back(sample);
    const auto wander = [&](int k) { return std::sin(2 * M_PI * t / (0.6 + 0.1 * k) + phase[k]); };
    *sample.p_WH += error * Vector3d(wander(0), wander(1), wander(2));
    *sample.R_WH =
        ExpRotation(error / 0.07 * Vector3d(wander(3), wander(4), wander(0))) * *sample.R_WH;
    for (auto& p : sample.p_WF) {
      for (int c = 0; c < 3; ++c) (*p)[c] += noise * Normal(engine);
    }
    reach.seen.samples.push_back(sample);
  }
  return reach;
}

// RMS over time of how far the true tips wander in the hand of `demonstration`, m, about where they
// are on average.
double Wander(const Reach& reach, const Demonstration& demonstration) {
  double sum = 0;
  const auto count = static_cast<double>(reach.truth.samples.size());
  for (int i = 0; i < kNumFingers; ++i) {
    Vector3d mean = Vector3d::Zero();
    double square = 0;
    for (std::size_t n = 0; n < reach.truth.samples.size(); ++n) {
      const DemonstrationSample &hand = demonstration.samples[n], &truth = reach.truth.samples[n];
      const Pose X_WH = MakePose(*hand.p_WH, *hand.R_WH);
      const Vector3d error = X_WH.inverse() * *truth.p_WF[i] - TipInHand(i, truth.t);
      mean += error / count;
      square += error.squaredNorm() / count;
    }
    sum += square - mean.squaredNorm();
  }
  return std::sqrt(sum / kNumFingers);
}

double LargestChange(const Demonstration& a, const Demonstration& b) {
  double largest = 0;
  for (std::size_t n = 0; n < a.samples.size(); ++n) {
    largest = std::max({largest, (*a.samples[n].p_WH - *b.samples[n].p_WH).norm(),
                        RotationDistance(*a.samples[n].R_WH, *b.samples[n].R_WH)});
  }
  return largest;
}

TEST(SteadyHand, TakesOutMostOfWhatTheSeenPoseWanders) {
  double before = 0, after = 0;
  for (int draw = 0; draw < 10; ++draw) {
    RandomEngine engine = MakeStream(1, draw, "steady");
    const Reach reach = Show(0.004, 0.0005, engine);
    before += Wander(reach, reach.seen);
    after += Wander(reach, WithSteadyHand(reach.seen, kPinch));
  }
  EXPECT_LT(after, 0.4 * before);
}

TEST(SteadyHand, RestsWhileTheTipsDo) {
  RandomEngine engine = MakeStream(2, 0, "steady");
  const Reach reach = Show(0.004, 0.0005, engine);
  const Demonstration steady = WithSteadyHand(reach.seen, {true, true, true, true, true});
  const auto way = [&](const Demonstration& d) {
    double sum = 0;
    for (std::size_t n = 1; n < d.samples.size(); ++n) {
      if (d.samples[n - 1].t < kStill + kMoves) continue;
      sum += (*d.samples[n].p_WH - *d.samples[n - 1].p_WH).norm();
    }
    return sum;
  };
  EXPECT_LT(way(steady), 0.6 * way(reach.seen));
}

TEST(SteadyHand, LeavesWhatIsExactOrHasNoOrientation) {
  RandomEngine engine = MakeStream(3, 0, "steady");
  Reach reach = Show(0, 0, engine);
  EXPECT_LT(LargestChange(WithSteadyHand(reach.seen, kPinch), reach.truth), 2e-4);
  for (DemonstrationSample& sample : reach.seen.samples) sample.R_WH.reset();
  const Demonstration same = WithSteadyHand(reach.seen, kPinch);
  EXPECT_FALSE(same.samples[5].R_WH);
  EXPECT_EQ(*same.samples[5].p_WH, *reach.seen.samples[5].p_WH);
}

// By quarter turns: noise is judged by coordinate.
TEST(SteadyHand, DoesNotDependOnTheWorldsFrame) {
  RandomEngine engine = MakeStream(4, 0, "steady");
  const Demonstration seen = Show(0.004, 0.0005, engine).seen;
  const Pose X_VW = MakePose(Vector3d(1, -2, 0.5), ExpRotation(Vector3d(0, M_PI / 2, 0)) *
                                                       ExpRotation(Vector3d(-M_PI / 2, 0, 0)));
  const auto moved = [&](Demonstration d) {
    for (DemonstrationSample& sample : d.samples) {
      *sample.p_WH = X_VW * *sample.p_WH;
      *sample.R_WH = Quaterniond(X_VW.linear()) * *sample.R_WH;
      for (auto& p : sample.p_WF) *p = X_VW * *p;
    }
    return d;
  };
  EXPECT_LT(LargestChange(WithSteadyHand(moved(seen), kPinch), moved(WithSteadyHand(seen, kPinch))),
            1e-8);
}

TEST(SteadyHand, GapsAreBridgedBetweenTheFirstAndTheLastPose) {
  RandomEngine engine = MakeStream(5, 0, "steady");
  Reach reach = Show(0.003, 0.0005, engine);
  auto& samples = reach.seen.samples;
  samples.front().p_WH.reset();
  for (std::size_t n = 15; n < 22; ++n) samples[n].R_WH.reset();
  for (std::size_t n = 14; n < 20; ++n) samples[n].p_WF[kIndex].reset();
  const Demonstration steady = WithSteadyHand(reach.seen, kPinch);
  EXPECT_FALSE(steady.samples.front().p_WH);
  for (std::size_t n = 1; n < samples.size(); ++n) {
    EXPECT_LT((*steady.samples[n].p_WH - *reach.truth.samples[n].p_WH).norm(), 0.01);
    EXPECT_LT(RotationDistance(*steady.samples[n].R_WH, *reach.truth.samples[n].R_WH), 0.15);
  }
  EXPECT_FALSE(steady.samples[16].p_WF[kIndex]);
}

}  // namespace
}  // namespace springgrasp
