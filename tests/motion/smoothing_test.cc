// Smoothing and derivatives of noisy recordings.
#include "motion/smoothing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "motion/dmp.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kTwoPi = 6.28318530717958647692;

MatrixXd Sine(const VectorXd& t, double frequency) {
  return (kTwoPi * frequency * t.array()).sin().matrix();
}

TEST(SmoothCurve, QuadraticsPassUnchangedWithTheirDerivatives) {
  const VectorXd t = EvenTimes(2.0, 0.04);
  const MatrixXd x = (0.3 - 0.2 * t.array() + 0.7 * t.array().square()).matrix();
  const MotionSamples out = SmoothSamples(t, x, 5, t);
  EXPECT_LT((out.x - x).cwiseAbs().maxCoeff(), 1e-8);
  EXPECT_LT((out.v.array() - (-0.2 + 1.4 * t.array())).abs().maxCoeff(), 1e-6);
  EXPECT_LT((out.a.array() - 1.4).abs().maxCoeff(), 1e-4);
}

TEST(SmoothCurve, PassesFrequenciesLikeItsCutoffSays) {
  const VectorXd t = EvenTimes(6.0, 0.01);
  const Index middle = t.size() / 3, length = t.size() / 3;
  for (const double frequency : {1.0, 2.5, 5.0, 8.0}) {
    const MatrixXd x = Sine(t, frequency);
    const MatrixXd out = SmoothSamples(t, x, 5, t).x;
    const double gain =
        out.col(0).segment(middle, length).norm() / x.col(0).segment(middle, length).norm();
    EXPECT_NEAR(gain, 1 / (1 + std::pow(frequency / 5, 6)), 0.02) << frequency << " Hz";
  }
}

TEST(SmoothCurve, DerivativesAreThoseOfTheCurve) {
  const VectorXd t = EvenTimes(2.0, 0.04);
  const SmoothCurve curve = FitSmoothCurve(t, Sine(t, 0.7), 6);
  for (double time = 0.1; time < 1.9; time += 0.083) {
    const double h = 1e-4;
    const MotionSamples near =
        EvaluateSmoothCurve(curve, Eigen::Vector3d(time - h, time, time + h));
    EXPECT_NEAR(near.v(1, 0), (near.x(2, 0) - near.x(0, 0)) / (2 * h), 1e-5);
    EXPECT_NEAR(near.a(1, 0), (near.v(2, 0) - near.v(0, 0)) / (2 * h), 1e-4);
  }
}

TEST(SmoothCurve, UnevenSamplesAndGapsAreBridged) {
  RandomEngine engine = MakeStream(1, 0, "gaps");
  std::vector<double> times;
  for (double t = 0; t < 3; t += Uniform(engine, 0.01, 0.06)) times.push_back(t);
  const VectorXd t = Eigen::Map<const VectorXd>(times.data(), static_cast<Index>(times.size()));
  MatrixXd x = Sine(t, 0.5);
  for (Index i = 0; i < t.size(); ++i) {
    if (t[i] > 1.2 && t[i] < 1.4) x(i, 0) = std::nan("");
  }
  const VectorXd even = EvenTimes(2.9, 0.02);
  const MotionSamples out = SmoothSamples(t, x, 6, even);
  EXPECT_LT((out.x - Sine(even, 0.5)).cwiseAbs().maxCoeff(), 2e-3);
}

TEST(SmoothCurve, ReducesNoiseAndNeedsFourSamples) {
  RandomEngine engine = MakeStream(2, 0, "noise");
  const VectorXd t = EvenTimes(3.0, 0.01);
  const MatrixXd truth = 0.05 * Sine(t, 0.5);
  MatrixXd x = truth;
  for (double& value : x.reshaped()) value += 0.001 * Normal(engine);
  EXPECT_LT((SmoothSamples(t, x, 5, t).x - truth).norm(), 0.45 * (x - truth).norm());
  EXPECT_THROW(FitSmoothCurve(t.head(3), x.topRows(3), 5), Error);
}

TEST(EstimateNoise, FindsTheDeviationDespiteMovementAndOutliers) {
  RandomEngine engine = MakeStream(3, 0, "estimate");
  const VectorXd t = EvenTimes(4.0, 1.0 / 23);
  for (const double noise : {0.0005, 0.001, 0.003}) {
    MatrixXd x = 0.1 * Sine(t, 0.5).replicate(1, 3);
    for (double& value : x.reshaped()) value += noise * Normal(engine);
    x(20, 1) += 0.1;
    EXPECT_NEAR(EstimateNoise(t, x), noise, 0.25 * noise);
  }
}

TEST(ChooseCutoff, FollowsNoiseAndRate) {
  EXPECT_NEAR(ChooseCutoff(0.0005, 23), 6, 1e-9);
  EXPECT_NEAR(ChooseCutoff(0.001, 23), 5, 1e-9);
  EXPECT_NEAR(ChooseCutoff(0.002, 23), 4, 1e-9);
  EXPECT_GT(ChooseCutoff(0.001, 100), ChooseCutoff(0.001, 23));
  EXPECT_LE(ChooseCutoff(0, 15), 5);
}

TEST(FiltFilt, HasNoDelayKeepsLinesAndHalvesAtTheCutoff) {
  const VectorXd t = EvenTimes(6.0, 0.01);
  const MatrixXd line = (1 + 2 * t.array()).matrix();
  EXPECT_LT((FiltFilt(line, 0.01, 5) - line).cwiseAbs().maxCoeff(), 1e-6);
  const MatrixXd x = Sine(t, 5);
  const MatrixXd out = FiltFilt(x, 0.01, 5);
  const Index a = t.size() / 3;
  // Two passes of 1/sqrt(2), in phase with the input.
  EXPECT_LT((out.middleRows(a, a) - 0.5 * x.middleRows(a, a)).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_THROW(FiltFilt(x, 0.01, 60), Error);
}

TEST(DifferentiateSamples, IsExactForCubicsAtUnevenTimes) {
  RandomEngine engine = MakeStream(4, 0, "cubic");
  VectorXd t(30);
  t[0] = 0;
  for (Index i = 1; i < t.size(); ++i) t[i] = t[i - 1] + Uniform(engine, 0.01, 0.05);
  const MatrixXd x = (1 - t.array() + 2 * t.array().square() - 3 * t.array().cube()).matrix();
  const MotionSamples out = DifferentiateSamples(t, x);
  EXPECT_LT((out.v.array() - (-1 + 4 * t.array() - 9 * t.array().square())).abs().maxCoeff(), 1e-9);
  EXPECT_LT((out.a.array() - (4 - 18 * t.array())).abs().maxCoeff(), 1e-7);
}

}  // namespace
}  // namespace springgrasp
