#include "kinematics/smooth_hand_ik.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "real_models.h"

namespace springgrasp {
namespace {

double Bend(const std::vector<Eigen::VectorXd>& motion) {
  double most = 0;
  for (std::size_t k = 2; k < motion.size(); ++k) {
    most = std::max(most, (motion[k] - 2 * motion[k - 1] + motion[k - 2]).cwiseAbs().maxCoeff());
  }
  return most;
}

// The relaxed hand whose index is drawn `far` (m) ahead and back, in 1 s.
std::vector<KnownTips> IndexAheadBy(const HumanHand& hand, double far) {
  std::vector<KnownTips> tips;
  for (int k = 0; k <= 200; ++k) {
    tips.push_back(TipsAt(hand, hand.rest));
    const double s = std::sin(M_PI * k / 200.0);
    *tips.back()[kIndex] += Eigen::Vector3d(far * s * s, 0, 0);
  }
  return tips;
}

TEST(SmoothHandIkTest, ReachesWhatCanBeReached) {
  const HumanHand& hand = TestHumanHand();
  const std::vector<KnownTips> tips = IndexAheadBy(hand, -0.02);
  const std::vector<Eigen::VectorXd> motion = SolveHandMotionSmoothly(hand, tips);
  ASSERT_EQ(motion.size(), tips.size());
  for (std::size_t k = 0; k < motion.size(); ++k) {
    EXPECT_TRUE((motion[k].array() >= hand.tree.lower.array()).all());
    EXPECT_TRUE((motion[k].array() <= hand.tree.upper.array()).all());
    const KnownTips found = TipsAt(hand, motion[k]);
    for (int f = 0; f < kNumFingers; ++f) EXPECT_LT((*found[f] - *tips[k][f]).norm(), 0.0005);
  }
}

TEST(SmoothHandIkTest, IsSmoothWhereATipLeavesTheReachAndComesBack) {
  const HumanHand& hand = TestHumanHand();
  const std::vector<KnownTips> tips = IndexAheadBy(hand, 0.12);
  const std::vector<Eigen::VectorXd> framewise = SolveHandMotion(hand, tips);
  const std::vector<Eigen::VectorXd> smooth = SolveHandMotionSmoothly(hand, tips);
  EXPECT_LT(Bend(smooth), 0.5 * Bend(framewise));
  // And is no farther from the tips for it, where they are far.
  const auto error = [&](const std::vector<Eigen::VectorXd>& motion) {
    return (*TipsAt(hand, motion[100])[kIndex] - *tips[100][kIndex]).norm();
  };
  EXPECT_NEAR(error(smooth), error(framewise), 0.001);
}

TEST(SmoothHandIkTest, FingersThatWereNotSeenRest) {
  const HumanHand& hand = TestHumanHand();
  std::vector<KnownTips> tips = IndexAheadBy(hand, 0.02);
  for (KnownTips& at : tips) at[kPinkie].reset();
  const std::vector<Eigen::VectorXd> motion = SolveHandMotionSmoothly(hand, tips);
  for (const int j : hand.joints[kPinkie]) {
    EXPECT_DOUBLE_EQ(motion[100][j], hand.rest[j]);
  }
}

}  // namespace
}  // namespace springgrasp
