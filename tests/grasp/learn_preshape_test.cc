// Where a hand opens to.
#include "grasp/learn_preshape.h"

#include <gtest/gtest.h>

#include <cmath>

namespace springgrasp {
namespace {

using Eigen::Vector3d;

// Thumb and index start 10 mm from their contacts and open along these ways, as a bell in time.
FitProblem Opening(const Vector3d& thumb, const Vector3d& index, double wobble) {
  FitProblem fit;
  fit.run.T = 1;
  fit.run.involved = {true, true, false, false, false};
  fit.run.p_HC.fill(Vector3d(0.1, 0, -0.05));
  fit.run.p_HF = fit.run.p_HC;
  fit.observed = fit.run.involved;
  for (int n = 0; n <= 100; ++n) {
    const double bell = std::pow(std::sin(M_PI * std::min(1.0, n / 100.0)), 2);
    Fingertips tips = fit.run.p_HC;
    const Vector3d noise = Vector3d(0, 0, wobble * (n % 2 ? 1 : -1));
    tips[kThumb] += bell * thumb + noise;
    tips[kIndex] += bell * index - noise;
    fit.p_HF.push_back(tips);
    fit.sample_t.push_back(n * fit.dt);
    PerFinger<std::optional<Vector3d>> seen;
    seen[kThumb] = tips[kThumb];
    seen[kIndex] = tips[kIndex];
    fit.sample_p_HF.push_back(seen);
  }
  return fit;
}

TEST(Preshape, IsTheWayThatTheFingersOpenedWhateverOneInstantSays) {
  const Vector3d thumb(-0.02, 0.01, 0), index(0.03, 0, 0.01);
  for (const double wobble : {0.0, 0.004}) {
    const FitProblem fit = Opening(thumb, index, wobble);
    const std::size_t widest = WidestInstant(fit);
    EXPECT_NEAR(static_cast<double>(widest), 50, 2);
    const Fingertips opening = Preshape(fit, widest);
    EXPECT_LT((opening[kThumb] - thumb).norm(), 0.1 * wobble + 0.002);
    EXPECT_LT((opening[kIndex] - index).norm(), 0.1 * wobble + 0.002);
    EXPECT_EQ(opening[kRing], Vector3d::Zero());
  }
}

TEST(WidestInstant, IsOneThatWasMeasured) {
  FitProblem fit = Opening(Vector3d(-0.02, 0, 0), Vector3d(0.02, 0, 0), 0);
  for (std::size_t n = 35; n < 65; ++n) fit.sample_p_HF[n][kIndex].reset();
  const std::size_t widest = WidestInstant(fit);
  EXPECT_GT(std::abs(static_cast<double>(widest) - 50), 9);
}

// The index opens on a parabola; beside the contact its way is the tangent there.
TEST(OpeningBend, IsThatOfTheArcOnWhichAFingerOpens) {
  const Vector3d index(0.04, 0, 0), bend(0, 8, -6);
  FitProblem fit = Opening(Vector3d(-0.03, 0, 0), index, 0);
  for (Fingertips& tips : fit.p_HF) {
    const double x = (tips[kIndex] - fit.run.p_HC[kIndex]).x();
    tips[kIndex] += 0.5 * x * (x - 0.04) * bend;
  }
  const std::size_t widest = WidestInstant(fit);
  Fingertips opening = Preshape(fit, widest);
  const Fingertips found = OpeningBend(fit, widest, opening);
  EXPECT_LT((found[kIndex] - bend).norm(), 0.1 * bend.norm());
  const Vector3d tangent = (Vector3d::UnitX() - 0.02 * bend).normalized();
  EXPECT_GT(opening[kIndex].normalized().dot(tangent), std::cos(0.05));
  EXPECT_LT(found[kThumb].norm(), 1e-6);
  EXPECT_EQ(found[kRing], Vector3d::Zero());
}

// The index comes back on a parabola, and later than the thumb.
TEST(ClosingBend, IsThatOfTheArcOnWhichAFingerComesBack) {
  const Vector3d index(0.04, 0, 0), bend(0, 3, -2);
  FitProblem fit = Opening(Vector3d(-0.03, 0, 0), index, 0);
  for (Fingertips& tips : fit.p_HF) {
    const double x = (tips[kIndex] - fit.run.p_HC[kIndex]).x();
    tips[kIndex] -= x * x * bend;
  }
  const Fingertips found = ClosingBend(fit);
  // Of the chord, which is turned against x by some 0.14 rad.
  EXPECT_NEAR(found[kIndex].norm(), bend.norm(), 0.05 * bend.norm());
  EXPECT_GT(found[kIndex].normalized().dot(bend.normalized()), std::cos(0.17));
  EXPECT_LT(found[kThumb].norm(), 1e-6);
  EXPECT_EQ(found[kRing], Vector3d::Zero());
}

TEST(ClosingBend, AndLagAreNotReadFromAFingerThatHardlyMoves) {
  const FitProblem fit = Opening(Vector3d(-0.009, 0, 0), Vector3d(0.04, 0, 0), 0);
  EXPECT_EQ(ClosingBend(fit)[kThumb], Vector3d::Zero());
  EXPECT_EQ(ClosingLag(fit)[kThumb], 0);
  EXPECT_EQ(ClosingLag(fit)[kIndex], 0);
}

TEST(ClosingLag, IsHowMuchLaterThanTheMeanAFingerCloses) {
  FitProblem fit = Opening(Vector3d(-0.03, 0, 0), Vector3d(0.04, 0, 0), 0);
  const std::vector<Fingertips> on_time = fit.p_HF;
  constexpr std::size_t kLater = 8;  // steps of 10 ms
  for (std::size_t n = kLater; n < fit.p_HF.size(); ++n) {
    fit.p_HF[n][kIndex] = on_time[n - kLater][kIndex];
  }
  const PerFinger<double> lag = ClosingLag(fit);
  EXPECT_NEAR(lag[kIndex], 0.04, 0.006);
  EXPECT_NEAR(lag[kThumb], -0.04, 0.006);
}

}  // namespace
}  // namespace springgrasp
