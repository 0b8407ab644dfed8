#include "vision/hand_follower.h"

#include <gtest/gtest.h>

#include <utility>

#include "vision/seen_hand.h"
#include "vision/synthetic_caps.h"
#include "vision/test_hand.h"

namespace springgrasp {
namespace {

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

// Fingers that were hidden together and come back, `seen` of them under the labels given.
struct Returning : Watching {
  Shown shown = Show(eyes);
  TrackedFrame start;

  Returning() {
    start = *follower.Start(tracker, shown.frame, false);
    follower.Follow(shown.frame, start, tracker, true);
    TrackedFrame hidden = start;
    for (int f = kIndex; f < kNumFingers; ++f) hidden.fingers[f] = TrackedFinger();
    for (int k = 0; k < 4; ++k) {
      TrackedFrame tracked = hidden;
      follower.Follow(shown.frame, tracked, tracker, false);
      follower.BetterLabels(shown.frame, tracker, tracked);
    }
  }
  // Of finger f the cap of finger cap[f] is taken; none for -1.
  TrackedFrame After(const PerFinger<int>& cap) {
    TrackedFrame tracked;
    for (int f = 0; f < kNumFingers; ++f) {
      if (cap[f] >= 0) tracked.fingers[f] = start.fingers[cap[f]];
    }
    follower.Follow(shown.frame, tracked, tracker, false);
    follower.BetterLabels(shown.frame, tracker, tracked);
    return tracked;
  }
  int Wrong(const TrackedFrame& tracked) const {
    int wrong = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      wrong += tracked.fingers[f].p_W && (*tracked.fingers[f].p_W - shown.tips[f]).norm() > 0.012;
    }
    return wrong;
  }
};

TEST(HandFollowerTest, OfFourFingersOneThatComesBackIsNotReportedSinceItMayBeAny) {
  for (const int cap : {1, 2, 3, 4}) {
    Returning hand;
    const TrackedFrame tracked = hand.After({0, cap, -1, -1, -1});
    EXPECT_EQ(tracked.num_seen(), 1);
    EXPECT_TRUE(tracked.fingers[kThumb].p_W);
  }
}

TEST(HandFollowerTest, FingersThatComeBackUnderNeighboursLabelsAreNotReportedThere) {
  for (const PerFinger<int>& caps : {PerFinger<int>{0, 2, 3, 4, -1}, PerFinger<int>{0, -1, 1, 2, 3},
                                     PerFinger<int>{0, 1, 2, 3, -1}}) {
    Returning hand;
    EXPECT_EQ(hand.Wrong(hand.After(caps)), 0);
  }
}

TEST(HandFollowerTest, AllFourFingersThatComeBackGetTheOrderOfTheHand) {
  Returning hand;
  const TrackedFrame tracked = hand.After({0, 3, 1, 4, 2});
  EXPECT_EQ(hand.Wrong(tracked), 0);
  EXPECT_EQ(tracked.num_seen(), kNumFingers);
}

}  // namespace
}  // namespace springgrasp
