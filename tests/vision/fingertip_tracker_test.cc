#include "vision/fingertip_tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "base/error.h"
#include "vision/synthetic_caps.h"

namespace springgrasp {
namespace {

struct Frame {
  cv::Mat left, right;
  std::vector<Eigen::Vector3d> tips;
};

// A hand that moves to the left and closes; with `cover` a bar stands before the ring finger's cap.
Frame Render(const StereoCameras& eyes, int k, bool cover) {
  const double s = k / 20.0;
  const DrawnHand hand = MakeDrawnHand({0.09 - 0.05 * s, 0.05, 0.62}, 0.6 * s);
  std::vector<DrawnCapsule> scene = hand.capsules;
  if (cover) {
    const Eigen::Vector3d before = hand.tips[kRing] - Eigen::Vector3d(-0.006, 0, 0.12);
    scene.push_back({before, before, 0.024, {160, 60, 60}});
  }
  return {DrawCapsules(eyes.left, scene), DrawCapsules(eyes.right, scene), hand.tips};
}

TrackerOptions Options() {
  TrackerOptions options;
  options.cap = {kCapRadius, kCapLength, 0};
  return options;
}

// Largest distance of a located finger from where it is; checks that none has another's place.
double LargestError(const TrackedFrame& frame, const std::vector<Eigen::Vector3d>& tips) {
  double largest = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    if (frame.fingers[f].p_W) {
      largest = std::max(largest, (*frame.fingers[f].p_W - tips[f]).norm());
    }
  }
  return largest;
}

// The first frame starts the tracker; nothing where it finds no hand.
std::optional<TrackedFrame> Track(FingertipTracker& tracker, const Frame& frame, int k,
                                  RandomEngine& engine) {
  if (k == 0) return tracker.Start(frame.left, frame.right);
  return tracker.Update(frame.left, frame.right, engine);
}

TEST(FingertipTrackerTest, FollowsAClosingHandToAFewMillimetres) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, Options());
  RandomEngine engine = MakeStream(1, 0, "observation");
  std::vector<double> errors;
  for (int k = 0; k <= 20; ++k) {
    const Frame frame = Render(eyes, k, false);
    const std::optional<TrackedFrame> seen = Track(tracker, frame, k, engine);
    ASSERT_TRUE(seen);
    const TrackedFrame& tracked = *seen;
    EXPECT_EQ(tracked.num_seen(), kNumFingers) << "frame " << k;
    EXPECT_LT(LargestError(tracked, frame.tips), 0.012) << "frame " << k;
    for (int f = 0; f < kNumFingers; ++f) {
      const TrackedFinger& finger = tracked.fingers[f];
      if (!finger.p_W) continue;
      errors.push_back((*finger.p_W - frame.tips[f]).norm());
      EXPECT_GE(finger.confidence, 0);
      EXPECT_LE(finger.confidence, 1);
    }
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.003);
}

TEST(FingertipTrackerTest, AHiddenFingerIsMissingThenFoundAgain) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, Options());
  RandomEngine engine = MakeStream(1, 0, "observation");
  for (int k = 0; k <= 16; ++k) {
    const bool covered = k >= 4 && k < 10;
    const Frame frame = Render(eyes, k, covered);
    const std::optional<TrackedFrame> seen = Track(tracker, frame, k, engine);
    ASSERT_TRUE(seen);
    const TrackedFrame& tracked = *seen;
    if (covered) {
      EXPECT_FALSE(tracked.fingers[kRing].p_W) << "invented in frame " << k;
      EXPECT_EQ(tracked.fingers[kRing].confidence, 0);
    }
    // Right again within five frames, and never in another's place.
    if (k >= 14) {
      EXPECT_TRUE(tracked.fingers[kRing].p_W) << "still lost in frame " << k;
    }
    EXPECT_LT(LargestError(tracked, frame.tips), 0.015) << "frame " << k;
    EXPECT_TRUE(tracked.fingers[kThumb].p_W && tracked.fingers[kPinkie].p_W);
  }
}

// The four fingers are hidden for a while; when they come back, the hand has turned by `degrees`
// about the line of sight, so that every finger stands where another one was expected.
Frame RenderTurned(const StereoCameras& eyes, bool covered, double degrees) {
  const Eigen::Vector3d palm(0.05, 0.05, 0.62);
  DrawnHand hand = MakeDrawnHand(palm, 0);
  const Eigen::AngleAxisd turn(degrees * M_PI / 180, Eigen::Vector3d::UnitZ());
  const auto turned = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return palm + turn * (p - palm);
  };
  for (Eigen::Vector3d& tip : hand.tips) tip = turned(tip);
  for (DrawnCapsule& capsule : hand.capsules) {
    capsule.a = turned(capsule.a);
    capsule.b = turned(capsule.b);
  }
  if (covered) {
    for (int f = kIndex; f < kNumFingers; ++f) {
      const Eigen::Vector3d before = hand.tips[f] - Eigen::Vector3d(-0.006, 0, 0.12);
      hand.capsules.push_back({before, before, 0.024, {160, 60, 60}});
    }
  }
  return {DrawCapsules(eyes.left, hand.capsules), DrawCapsules(eyes.right, hand.capsules),
          hand.tips};
}

TEST(FingertipTrackerTest, LabelsExchangedWhileHiddenAreRestored) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, Options());
  RandomEngine engine = MakeStream(1, 0, "observation");
  double last = 0, worst = 0;
  for (int k = 0; k <= 15; ++k) {
    const Frame frame =
        RenderTurned(eyes, k >= 3 && k < 8, k < 3 ? 0 : std::min(1.0, (k - 2) / 5.0) * 20);
    const std::optional<TrackedFrame> seen = Track(tracker, frame, k, engine);
    ASSERT_TRUE(seen);
    last = LargestError(*seen, frame.tips);
    worst = std::max(worst, last);
  }
  ASSERT_GT(worst, 0.02) << "nothing was exchanged";
  EXPECT_LT(last, 0.012);
}

// Caps are 38 mm apart; a jump of 30 degrees in one frame puts two fingers onto one cap.
TEST(FingertipTrackerTest, NoTwoFingersStayOnOneCap) {
  for (const double degrees : {-30.0, 30.0}) {
    const StereoCameras eyes = TestEyes();
    FingertipTracker tracker(eyes, Options());
    RandomEngine engine = MakeStream(1, 0, "observation");
    for (int k = 0; k <= 8; ++k) {
      const Frame frame = RenderTurned(eyes, false, k < 2 ? 0 : degrees);
      const std::optional<TrackedFrame> seen = Track(tracker, frame, k, engine);
      ASSERT_TRUE(seen);
      for (int f = 0; f < kNumFingers; ++f) {
        for (int g = 0; g < f; ++g) {
          if (!seen->fingers[f].p_W || !seen->fingers[g].p_W) continue;
          EXPECT_GT((*seen->fingers[f].p_W - *seen->fingers[g].p_W).norm(), 0.02)
              << kFingerNames[f] << " and " << kFingerNames[g] << ", " << degrees
              << " degrees, frame " << k;
        }
      }
    }
  }
}

// From rest to `step` m per frame at once, past a green ball behind it if there is one.
void ExpectRightWhileMoving(const Eigen::Vector3d& step, bool green_ball) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, Options());
  RandomEngine engine = MakeStream(1, 0, "observation");
  Eigen::Vector3d palm(0.12, 0.05, 0.62);
  for (int k = 0; k <= 9; ++k) {
    if (k >= 3) palm += step;
    DrawnHand hand = MakeDrawnHand(palm, 0);
    if (green_ball) {
      const Eigen::Vector3d ball(-0.02, -0.02, 0.85);
      hand.capsules.push_back({ball, ball, 0.06, {25, 150, 25}});
    }
    const Frame frame = {DrawCapsules(eyes.left, hand.capsules),
                         DrawCapsules(eyes.right, hand.capsules), hand.tips};
    const std::optional<TrackedFrame> seen = Track(tracker, frame, k, engine);
    ASSERT_TRUE(seen);
    // Half the way to a neighbour.
    EXPECT_LT(LargestError(*seen, frame.tips), 0.019) << "frame " << k;
    if (!green_ball || k == 9) {
      EXPECT_EQ(seen->num_seen(), kNumFingers) << "frame " << k;
    }
  }
}

TEST(FingertipTrackerTest, AHandThatLeavesAtOnceByMoreThanAFingersWidthKeepsItsLabels) {
  ExpectRightWhileMoving({-0.03, 0, 0}, false);
  ExpectRightWhileMoving({0.012, -0.02, 0}, false);
}

TEST(FingertipTrackerTest, SomethingLargeOfTheCapsColourDoesNotLeadAFingerAway) {
  ExpectRightWhileMoving({-0.025, 0, 0}, true);
}

TEST(FingertipTrackerTest, AStartMayPassOverTheLikeliestCaps) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, Options());
  DrawnHand hand = MakeDrawnHand({0.05, 0.05, 0.62}, 0);
  const Eigen::Vector3d sixth(-0.08, 0.02, 0.6);
  hand.capsules.push_back({sixth, sixth, kCapRadius, {20, 160, 20}});
  const cv::Mat left = DrawCapsules(eyes.left, hand.capsules);
  const cv::Mat right = DrawCapsules(eyes.right, hand.capsules);
  const auto found = [&](int choice) {
    const auto start = tracker.Start(left, right, choice);
    int of_hand = 0;
    for (const Eigen::Vector3d& tip : hand.tips) {
      for (const TrackedFinger& finger : start->fingers) {
        of_hand += finger.p_W && (*finger.p_W - tip).norm() < 0.012;
      }
    }
    return of_hand;
  };
  EXPECT_EQ(found(0), 5);
  EXPECT_EQ(found(1), 4);  // with the sixth
  EXPECT_FALSE(tracker.Start(left, right, 1000));
}

TEST(FingertipTrackerTest, EqualFramesAndSeedGiveEqualNumbers) {
  const StereoCameras eyes = TestEyes();
  std::vector<Eigen::Vector3d> runs[2];
  for (auto& run : runs) {
    FingertipTracker tracker(eyes, Options());
    RandomEngine engine = MakeStream(5, 0, "observation");
    for (int k = 0; k < 3; ++k) {
      const Frame frame = Render(eyes, k, false);
      const TrackedFrame tracked = k == 0 ? *tracker.Start(frame.left, frame.right)
                                          : tracker.Update(frame.left, frame.right, engine);
      for (const TrackedFinger& finger : tracked.fingers) {
        if (finger.p_W) run.push_back(*finger.p_W);
      }
    }
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(FingertipTrackerTest, DoesNotStartOnAnEmptyWall) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, {});
  EXPECT_FALSE(tracker.Start(DrawCapsules(eyes.left, {}), DrawCapsules(eyes.right, {})));
  EXPECT_FALSE(tracker.started());
}

TEST(FingertipTrackerTest, PicturesOfAnotherSizeAreRefused) {
  FingertipTracker tracker(TestEyes(), {});
  const cv::Mat small(240, 320, CV_8UC3);
  EXPECT_THROW(tracker.Start(small, small), Error);
}

TEST(FingertipTrackerTest, FindsTheSizeOfTheCapsItself) {
  const StereoCameras eyes = TestEyes();
  FingertipTracker tracker(eyes, {});
  const Frame frame = Render(eyes, 0, false);
  ASSERT_TRUE(tracker.Start(frame.left, frame.right));
  EXPECT_NEAR(tracker.cap().radius, kCapRadius, 0.15 * kCapRadius);
}

}  // namespace
}  // namespace springgrasp
