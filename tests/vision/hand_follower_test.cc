#include "vision/hand_follower.h"

#include <gtest/gtest.h>

#include <utility>

#include "vision/synthetic_caps.h"
#include "vision/test_hand.h"

namespace springgrasp {
namespace {

// The model's own hand, palm to the eyes, drawn with caps and skin.
struct Shown {
  StereoFrame frame;
  PerFinger<Eigen::Vector3d> tips;
};

Shown Show(const StereoCameras& eyes, const std::vector<DrawnCapsule>& others = {}) {
  const HandModel model = MakeHandModel(TestHand());
  HandFit hand;
  hand.q = model.rest;
  // Fingers up in the picture, z of H away from the eyes.
  hand.X_WH.linear().col(0) = -Eigen::Vector3d::UnitY();
  hand.X_WH.linear().col(1) = Eigen::Vector3d::UnitX();
  hand.X_WH.linear().col(2) = Eigen::Vector3d::UnitZ();
  hand.X_WH.translation() = Eigen::Vector3d(0.03, 0.1, 0.6);
  const Eigen::Vector3d palm = PalmOf(hand), wrist = hand.X_WH.translation();
  std::vector<DrawnCapsule> scene = others;
  Shown shown;
  for (int f = 0; f < kNumFingers; ++f) {
    const Eigen::Vector3d tip = shown.tips[f] = FittedTip(model, hand, f);
    const Eigen::Vector3d axis = FittedAxis(model, hand, f);
    const double half = 0.5 * kCapLength - kCapRadius;
    scene.push_back({tip - half * axis, tip + half * axis, kCapRadius, {20, 160, 20}});
    scene.push_back({tip - 0.004 * axis, tip - 0.035 * axis, 0.0078, kSkin});
    scene.push_back({tip - 0.035 * axis, palm, 0.0085, kSkin});
  }
  scene.push_back({palm, wrist, 0.033, kSkin});
  scene.push_back({wrist, wrist + Eigen::Vector3d(0, 0.2, 0), 0.026, kSkin});
  shown.frame.left = DrawCapsules(eyes.left, scene);
  shown.frame.right = DrawCapsules(eyes.right, scene);
  return shown;
}

double Farthest(const TrackedFrame& tracked, const Shown& shown) {
  double farthest = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!tracked.fingers[f].p_W) return 1;
    farthest = std::max(farthest, (*tracked.fingers[f].p_W - shown.tips[f]).norm());
  }
  return farthest;
}

struct Watching {
  StereoCameras eyes = TestEyes();
  FingertipTracker tracker{eyes, {}};
  HandFollower follower{TestHand(), eyes, {}, std::nullopt};
};

TEST(HandFollowerTest, StartsWithTheHandsOwnLabels) {
  Watching w;
  const Shown shown = Show(w.eyes);
  const auto tracked = w.follower.Start(w.tracker, shown.frame, false);
  ASSERT_TRUE(tracked);
  EXPECT_LT(Farthest(*tracked, shown), 0.012);
}

TEST(HandFollowerTest, ASixthCapOfTheSameSizeBesideTheHandIsLeftAside) {
  Watching w;
  const Eigen::Vector3d sixth(-0.07, 0.06, 0.6);
  const Shown shown = Show(w.eyes, {{sixth, sixth, kCapRadius, {20, 160, 20}}});
  const auto tracked = w.follower.Start(w.tracker, shown.frame, false);
  ASSERT_TRUE(tracked);
  EXPECT_LT(Farthest(*tracked, shown), 0.012);
}

TEST(HandFollowerTest, FiveCapsThatAreNoHandDoNotStartUnlessTheyMust) {
  Watching w;
  std::vector<DrawnCapsule> row;
  for (int i = 0; i < kNumFingers; ++i) {
    const Eigen::Vector3d at(-0.1 + 0.05 * i, 0.02 * (i % 2), 0.6 + 0.05 * (i % 3));
    row.push_back({at, at, kCapRadius, {20, 160, 20}});
  }
  StereoFrame frame;
  frame.left = DrawCapsules(w.eyes.left, row);
  frame.right = DrawCapsules(w.eyes.right, row);
  EXPECT_FALSE(w.follower.Start(w.tracker, frame, false));
  EXPECT_TRUE(w.follower.Start(w.tracker, frame, true));
}

TEST(HandFollowerTest, ExchangedLabelsAreNoticedByTheHandThatTheyDoNotFit) {
  Watching w;
  const Shown shown = Show(w.eyes);
  const auto start = w.follower.Start(w.tracker, shown.frame, false);
  ASSERT_TRUE(start);
  ASSERT_NE(w.follower.Follow(shown.frame, *start, w.tracker, true), nullptr);
  TrackedFrame tracked = *start;
  EXPECT_FALSE(w.follower.BetterLabels(shown.frame, w.tracker, tracked));
  const PerFinger<int> exchange = {kMiddle, kIndex, kThumb, kRing, kPinkie};
  std::optional<PerFinger<int>> order;
  for (int k = 0; k < 5 && !order; ++k) {
    for (int f = 0; f < kNumFingers; ++f) tracked.fingers[f] = start->fingers[exchange[f]];
    w.follower.Follow(shown.frame, tracked, w.tracker, false);
    order = w.follower.BetterLabels(shown.frame, w.tracker, tracked);
  }
  ASSERT_TRUE(order);
  EXPECT_EQ(*order, exchange);
  EXPECT_LT(Farthest(tracked, shown), 0.012);
}

}  // namespace
}  // namespace springgrasp
