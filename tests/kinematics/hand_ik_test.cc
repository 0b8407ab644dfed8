#include "kinematics/hand_ik.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "real_models.h"

namespace springgrasp {
namespace {

bool WithinRanges(const KinematicTree& tree, const Eigen::VectorXd& q) {
  return (q.array() >= tree.lower.array()).all() && (q.array() <= tree.upper.array()).all();
}

// A posture that a hand takes: fingers flex together, little abduction.
Eigen::VectorXd PlausiblePosture(const HumanHand& hand, RandomEngine& engine) {
  Eigen::VectorXd q = hand.rest;
  const double together = Uniform01(engine);
  for (int f = 0; f < kNumFingers; ++f) {
    const std::vector<int>& j = hand.joints[f];
    for (std::size_t i = 0; i < j.size(); ++i) {
      const double low = hand.tree.lower[j[i]], high = hand.tree.upper[j[i]];
      const bool abduction = f != kThumb && i + 4 == j.size();
      q[j[i]] = abduction ? Uniform(engine, -0.25, 0.25)
                          : low + (high - low) * (0.6 * together + 0.3 * Uniform01(engine));
    }
  }
  return q;
}

TEST(HandIkTest, ReachesTheTipsOfPlausiblePosturesFromCold) {
  const HumanHand& hand = TestHumanHand();
  RandomEngine engine = MakeStream(1, 0, "hand ik");
  std::vector<double> errors;
  for (int trial = 0; trial < 200; ++trial) {
    const HandIkResult result = SolveHandIk(hand, TipsAt(hand, PlausiblePosture(hand, engine)));
    EXPECT_TRUE(WithinRanges(hand.tree, result.q));
    errors.insert(errors.end(), result.error.begin(), result.error.end());
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.0002);
  EXPECT_LT(errors[errors.size() * 99 / 100], 0.001);
}

TEST(HandIkTest, AMotionIsFollowedSmoothly) {
  const HumanHand& hand = TestHumanHand();
  RandomEngine engine = MakeStream(2, 0, "hand ik");
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::VectorXd from = PlausiblePosture(hand, engine),
                          to = PlausiblePosture(hand, engine);
    std::vector<KnownTips> tips;
    for (int i = 0; i <= 100; ++i) {
      const double s = i / 100.0, blend = s * s * (3 - 2 * s);
      tips.push_back(TipsAt(hand, from + blend * (to - from)));
    }
    const std::vector<Eigen::VectorXd> motion = SolveHandMotion(hand, tips);
    for (std::size_t i = 1; i < motion.size(); ++i) {
      EXPECT_LT((motion[i] - motion[i - 1]).cwiseAbs().maxCoeff(), 0.06) << i;
    }
    const KnownTips last = TipsAt(hand, motion.back());
    for (int f = 0; f < kNumFingers; ++f) {
      EXPECT_LT((*last[f] - *tips.back()[f]).norm(), 0.001);
    }
  }
}

TEST(HandIkTest, FingersThatWereNotSeenRest) {
  const HumanHand& hand = TestHumanHand();
  KnownTips tips = TipsAt(hand, hand.rest);
  tips[kRing].reset();
  tips[kPinkie].reset();
  *tips[kIndex] += Eigen::Vector3d(-0.02, 0, -0.01);
  const HandIkResult result = SolveHandIk(hand, tips);
  for (const int f : {kRing, kPinkie}) {
    for (const int j : hand.joints[f]) EXPECT_DOUBLE_EQ(result.q[j], hand.rest[j]);
  }
  EXPECT_LT(result.error[kIndex], 0.001);
}

TEST(HandIkTest, TipsOutOfReachEndAtTheRangesNotBeyond) {
  const HumanHand& hand = TestHumanHand();
  KnownTips tips = TipsAt(hand, hand.rest);
  *tips[kMiddle] = Eigen::Vector3d(0.4, 0, 0.1);
  const HandIkResult result = SolveHandIk(hand, tips);
  EXPECT_TRUE(WithinRanges(hand.tree, result.q));
  EXPECT_GT(result.error[kMiddle], 0.1);
}

TEST(HandIkTest, FindsTheWristWhereItWasNotRecorded) {
  const HumanHand& hand = TestHumanHand();
  RandomEngine engine = MakeStream(3, 0, "hand ik");
  for (int trial = 0; trial < 20; ++trial) {
    const Pose X_WH = MakePose({0.3, 0.5, 1.1}, ExpRotation({Normal(engine), Normal(engine), 0.3}));
    KnownTips tips = TipsAt(hand, PlausiblePosture(hand, engine));
    for (auto& tip : tips) *tip = X_WH * *tip;
    const Pose X_prior = X_WH * MakePose({0.01, -0.01, 0.01}, ExpRotation({0.1, -0.05, 0.1}));
    const HandPoseIkResult result = SolveHandPoseIk(hand, tips, X_prior);
    EXPECT_TRUE(WithinRanges(hand.tree, result.q));
    for (int f = 0; f < kNumFingers; ++f) EXPECT_LT(result.error[f], 0.001);
    EXPECT_LT((result.X_WH.translation() - X_WH.translation()).norm(), 0.04);
  }
}

TEST(HandIkTest, TwoFingersAloneGiveAHandPose) {
  const HumanHand& hand = TestHumanHand();
  KnownTips tips;
  tips[kThumb] = Eigen::Vector3d(0.02, 0.4, 1.0);
  tips[kIndex] = Eigen::Vector3d(-0.01, 0.44, 1.01);
  const Pose X_prior = PriorHandPose(hand, tips, Eigen::Vector3d::UnitZ());
  const HandPoseIkResult result = SolveHandPoseIk(hand, tips, X_prior);
  EXPECT_LT(result.error[kThumb], 0.001);
  EXPECT_LT(result.error[kIndex], 0.001);
  EXPECT_GT(result.X_WH.linear().col(2).z(), 0.3) << "the back of the hand is up";
  tips[kIndex].reset();
  EXPECT_THROW(PriorHandPose(hand, tips, Eigen::Vector3d::UnitZ()), Error);
}

TEST(HandIkTest, AFrameTakesUnderAMillisecond) {
  const HumanHand& hand = TestHumanHand();
  RandomEngine engine = MakeStream(4, 0, "hand ik");
  const Eigen::VectorXd from = PlausiblePosture(hand, engine), to = PlausiblePosture(hand, engine);
  std::vector<KnownTips> tips;
  for (int i = 0; i <= 400; ++i) tips.push_back(TipsAt(hand, from + i / 400.0 * (to - from)));
  const auto begin = std::chrono::steady_clock::now();
  SolveHandMotion(hand, tips);
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
  RecordProperty("ms_per_frame", std::to_string(spent.count() / 0.401));
  EXPECT_LT(spent.count() / 401, 0.004) << "aim: 1 ms on an idle machine; 4 ms on a loaded one";
}

}  // namespace
}  // namespace springgrasp
