#include "vision/track_demonstration.h"

#include <gtest/gtest.h>

#include <set>

#include "base/error.h"
#include "vision/overlay.h"
#include "vision/seen_hand.h"
#include "vision/synthetic_caps.h"

namespace springgrasp {
namespace {

// `blank` empty frames, then a hand at rest; 30 Hz from t = 5 s.
FrameSource Frames(const StereoCameras& eyes, int blank, int count, int& next) {
  return [&eyes, blank, count, &next]() -> std::optional<StereoFrame> {
    if (next >= count) return std::nullopt;
    std::vector<DrawnCapsule> scene;
    if (next >= blank) scene = MakeDrawnHand({0.05, 0.05, 0.6}, 0).capsules;
    StereoFrame frame;
    frame.t = 5 + next++ / 30.0;
    frame.left = DrawCapsules(eyes.left, scene);
    frame.right = DrawCapsules(eyes.right, scene);
    return frame;
  };
}

TEST(TrackStereoTest, TheLeadInIsDroppedAndTimeStartsAfterIt) {
  const StereoCameras eyes = TestEyes();
  int next = 0, called = 0;
  TrackDemonstrationOptions options;
  options.lead_in = 0.1;
  RandomEngine engine = MakeStream(1, 0, "observation");
  TrackingSummary summary;
  const Demonstration demonstration = TrackStereo(
      Frames(eyes, 0, 6, next), eyes, nullptr, options, engine,
      [&](const TrackedInstant& instant) {
        ++called;
        EXPECT_EQ(instant.tracked.num_seen(), kNumFingers);
        EXPECT_EQ(instant.hand, nullptr);
      },
      &summary);
  EXPECT_EQ(called, 6);
  ASSERT_EQ(demonstration.samples.size(), 3U);
  EXPECT_NEAR(demonstration.samples[0].t, 0, 1e-9);
  EXPECT_NEAR(demonstration.samples[2].t, 2 / 30.0, 1e-9);
  EXPECT_FALSE(demonstration.samples[0].p_WH);  // no hand model, no wrist
  EXPECT_EQ(summary.coverage[kThumb], 1);
  EXPECT_LT(summary.epipolar_px, 1);
}

TEST(TrackStereoTest, CapsMayAppearALittleLate) {
  const StereoCameras eyes = TestEyes();
  int next = 0;
  RandomEngine engine = MakeStream(1, 0, "observation");
  const Demonstration demonstration =
      TrackStereo(Frames(eyes, 2, 5, next), eyes, nullptr, {}, engine);
  ASSERT_EQ(demonstration.samples.size(), 3U);
  EXPECT_NEAR(demonstration.samples[0].t, 2 / 30.0, 1e-9);
}

TEST(TrackStereoTest, NoVideoAndNoCapsAreErrors) {
  const StereoCameras eyes = TestEyes();
  RandomEngine engine = MakeStream(1, 0, "observation");
  int next = 0;
  EXPECT_THROW(TrackStereo(Frames(eyes, 0, 0, next), eyes, nullptr, {}, engine), Error);
  TrackDemonstrationOptions options;
  options.max_wait = 0.05;
  EXPECT_THROW(TrackStereo(Frames(eyes, 9, 9, next), eyes, nullptr, options, engine), Error);
}

TEST(TrackStereoTest, AHandThatWasGoneIsFoundWhereverItComesBack) {
  constexpr int kBefore = 3, kGone = 6, kAfter = 6;
  const StereoCameras eyes = TestEyes();
  const Shown here = Show(eyes), there = Show(eyes, {}, {-0.09, 0.12, 0.66});
  StereoFrame empty;
  empty.left = DrawCapsules(eyes.left, {});
  empty.right = DrawCapsules(eyes.right, {});
  int next = 0;
  const FrameSource source = [&]() -> std::optional<StereoFrame> {
    if (next == kBefore + kGone + kAfter) return std::nullopt;
    StereoFrame frame = next < kBefore ? here.frame : next < kBefore + kGone ? empty : there.frame;
    frame.t = next++ / 30.0;
    return frame;
  };
  const KinematicTree hand = TestHand();
  RandomEngine engine = MakeStream(1, 0, "observation");
  const Demonstration demonstration = TrackStereo(source, eyes, &hand, {}, engine);
  ASSERT_EQ(demonstration.samples.size(), static_cast<std::size_t>(next));
  for (int i = kBefore; i < kBefore + kGone; ++i) {
    for (const auto& tip : demonstration.samples[i].p_WF) EXPECT_FALSE(tip);
  }
  for (int f = 0; f < kNumFingers; ++f) {
    const auto& tip = demonstration.samples.back().p_WF[f];
    ASSERT_TRUE(tip);
    EXPECT_LT((*tip - there.tips[f]).norm(), 0.012);
  }
}

TEST(OverlayTest, ViewsStandSideBySideWithAColourForEachFinger) {
  const StereoCameras eyes = TestEyes();
  const auto scene = MakeDrawnHand({0.05, 0.05, 0.6}, 0).capsules;
  const cv::Mat left = DrawCapsules(eyes.left, scene), right = DrawCapsules(eyes.right, scene);
  FingertipTracker tracker(eyes, {});
  const auto frame = tracker.Start(left, right);
  ASSERT_TRUE(frame);
  const cv::Mat overlay = DrawOverlay(left, right, eyes, *frame, kCapRadius);
  EXPECT_EQ(overlay.cols, 2 * left.cols);
  EXPECT_EQ(overlay.rows, left.rows);
  for (int f = 0; f < kNumFingers; ++f) {
    for (int v = 0; v < 2; ++v) {
      int count = 0;
      const cv::Mat half = overlay(cv::Rect(v * left.cols, 0, left.cols, left.rows));
      for (int y = 0; y < half.rows; ++y) {
        for (int x = 0; x < half.cols; ++x) {
          const cv::Vec3b p = half.at<cv::Vec3b>(y, x);
          count += p[0] == kFingerColours[f][0] && p[1] == kFingerColours[f][1] &&
                   p[2] == kFingerColours[f][2];
        }
      }
      EXPECT_GT(count, 20) << kFingerNames[f] << " in view " << v;
    }
  }
  // The pictures handed in are left alone.
  EXPECT_EQ(cv::norm(left, DrawCapsules(eyes.left, scene), cv::NORM_INF), 0);
}

}  // namespace
}  // namespace springgrasp
