#include "experiment/simulated_eyes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "experiment/observe.h"

namespace springgrasp {
namespace {

Scene PinchScene() {
  Scene scene;
  scene.source = "test";
  scene.demonstrator.object = ParseShape("sphere:0.04");
  return scene;
}

// Stage, motion and eyes of a scene.
struct Setup {
  explicit Setup(const Scene& scene, double fps = 20)
      : stage(scene, std::nullopt), engine(MakeStream(3, 0, "observation")) {
    motion = PrepareDemonstration(scene, stage, engine);
    shown = Resampled(motion, fps);
    eyes.emplace(stage, stage.eyes_settings(), motion, shown, engine);
  }
  std::size_t middle() const { return shown.samples.size() / 2; }

  ObserveStage stage;
  RandomEngine engine;
  HandMotion motion, shown;
  std::optional<SimulatedEyes> eyes;
};

// Middle of the largest spot of cap green, px.
Eigen::Vector2d LargestCap(const cv::Mat& bgr) {
  cv::Mat hsv, mask, labels, stats, centroids;
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  cv::inRange(hsv, cv::Scalar(50, 120, 60), cv::Scalar(75, 255, 255), mask);
  const int n = cv::connectedComponentsWithStats(mask, labels, stats, centroids);
  int best = 1;
  for (int i = 2; i < n; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) > stats.at<int>(best, cv::CC_STAT_AREA)) best = i;
  }
  EXPECT_GT(n, 1);
  return {centroids.at<double>(best, 0), centroids.at<double>(best, 1)};
}

bool Same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

TEST(SimulatedEyesTest, AreIdealWhereNothingIsAskedFor) {
  Setup s(PinchScene());
  const StereoFrame frame = s.eyes->Look(s.middle());
  s.stage.Show(s.shown.samples[s.middle()], s.motion.object);
  EXPECT_TRUE(Same(frame.left, s.stage.Picture(0)));
  EXPECT_TRUE(Same(frame.right, s.stage.Picture(1)));
  EXPECT_EQ(frame.t, s.shown.samples[s.middle()].t);
  EXPECT_EQ(s.eyes->told().left.fx, s.stage.eyes().left.fx);
  EXPECT_EQ(s.eyes->told().right.X_WC.matrix(), s.stage.eyes().right.X_WC.matrix());
}

TEST(SimulatedEyesTest, TheTrackersCamerasProjectToWhereTheLensPutsThings) {
  Scene scene = PinchScene();
  Setup straight(scene);
  scene.eyes.distortion = {-0.25, 0.08, 0.002, -0.001, 0};
  Setup bent(scene);
  double largest = 0;
  for (const std::size_t frame : {std::size_t{0}, straight.middle(), std::size_t{25}}) {
    const StereoFrame a = straight.eyes->Look(frame), b = bent.eyes->Look(frame);
    for (int eye = 0; eye < 2; ++eye) {
      const Eigen::Vector2d at = LargestCap(eye == 0 ? a.left : a.right);
      const CameraModel& pinhole = straight.stage.eyes().view(eye);
      const Eigen::Vector3d p_W = pinhole.X_WC.translation() + PixelRay(pinhole, at);
      const auto expected = Project(bent.stage.eyes().view(eye), p_W);
      ASSERT_TRUE(expected.has_value());
      EXPECT_LT((LargestCap(eye == 0 ? b.left : b.right) - *expected).norm(), 0.3);
      largest = std::max(largest, (*expected - at).norm());
    }
  }
  EXPECT_GT(largest, 2) << "the lens moves things";
}

TEST(SimulatedEyesTest, PicturesAreAsLargeAsAskedAndSeeTheSame) {
  Scene scene = PinchScene();
  Setup usual(scene);
  scene.eyes.width = 1280;
  scene.eyes.height = 960;
  Setup large(scene);
  const StereoFrame a = usual.eyes->Look(0), b = large.eyes->Look(0);
  ASSERT_EQ(b.left.size(), cv::Size(1280, 960));
  EXPECT_EQ(large.stage.eyes().left.width, 1280);
  const Eigen::Vector2d expected = 2 * LargestCap(a.left) + Eigen::Vector2d(0.5, 0.5);
  EXPECT_LT((LargestCap(b.left) - expected).norm(), 1);
}

TEST(SimulatedEyesTest, AnExposureSmearsAboutItsMiddle) {
  Scene scene = PinchScene();
  scene.demonstrator.speed = 1;
  Setup sharp(scene, 60);
  scene.eyes.exposure = 0.01;
  Setup smeared(scene, 60);
  const std::size_t frame = 50;
  const StereoFrame a = sharp.eyes->Look(frame), b = smeared.eyes->Look(frame);
  EXPECT_FALSE(Same(a.left, b.left));
  EXPECT_LT((LargestCap(a.left) - LargestCap(b.left)).norm(), 1.5);
  // At rest nothing is smeared.
  const std::size_t last = sharp.shown.samples.size() - 1;
  EXPECT_TRUE(Same(sharp.eyes->Look(last).left, smeared.eyes->Look(last).left));
}

TEST(SimulatedEyesTest, TheRightEyeMayBeLate) {
  Scene scene = PinchScene();
  scene.eyes.time_offset = 0.02;
  Setup s(scene);
  const StereoFrame frame = s.eyes->Look(s.middle());
  s.stage.Show(s.shown.samples[s.middle()], s.motion.object);
  EXPECT_TRUE(Same(frame.left, s.stage.Picture(0)));
  EXPECT_FALSE(Same(frame.right, s.stage.Picture(1)));
  s.stage.Show(Interpolated(s.motion, s.shown.samples[s.middle()].t + 0.02), s.motion.object);
  EXPECT_TRUE(Same(frame.right, s.stage.Picture(1)));
}

TEST(SimulatedEyesTest, DropsPairsButNeverTheFirst) {
  Scene scene = PinchScene();
  scene.eyes.frame_drops = 0.3;
  Setup s(scene, 200);
  int dropped = 0;
  for (std::size_t i = 0; i < s.shown.samples.size(); ++i) dropped += s.eyes->IsDropped(i);
  const double share = dropped / double(s.shown.samples.size());
  EXPECT_NEAR(share, 0.3, 0.1);
  EXPECT_FALSE(s.eyes->IsDropped(0));
}

TEST(SimulatedEyesTest, LightAndWhiteBalanceDrift) {
  Scene scene = PinchScene();
  scene.eyes.brightness_drift = 0.4;
  Setup light(scene, 10);
  scene.eyes.brightness_drift = 0;
  scene.eyes.white_balance_drift = 0.3;
  Setup white(scene, 10);
  Setup plain(PinchScene(), 10);
  double low = 9, high = 0, apart = 0;
  for (std::size_t i = 0; i < plain.shown.samples.size(); ++i) {
    const cv::Scalar a = cv::mean(plain.eyes->Look(i).left), b = cv::mean(light.eyes->Look(i).left),
                     c = cv::mean(white.eyes->Look(i).left);
    low = std::min(low, b[1] / a[1]);
    high = std::max(high, b[1] / a[1]);
    EXPECT_NEAR(b[0] / a[0], b[2] / a[2], 0.05) << "all channels alike";
    apart = std::max(apart, std::abs(c[0] / a[0] - c[2] / a[2]));
  }
  EXPECT_NEAR(high - low, 0.4, 0.06);
  EXPECT_GT(apart, 0.03);
}

TEST(SimulatedEyesTest, APlateHidesACapFromBothEyesForItsFrames) {
  Scene scene = PinchScene();
  scene.demonstrator.occlusion.fingers = {kIndex};
  scene.demonstrator.occlusion.frames = 4;
  Setup s(scene);
  int covered = 0;
  for (std::size_t i = 0; i < s.shown.samples.size(); ++i) {
    if (!s.eyes->IsCovered(i)) continue;
    ++covered;
    s.eyes->Show(i);
    for (int eye = 0; eye < 2; ++eye) EXPECT_LT(s.stage.VisibleCaps(eye)[kIndex], 0.05);
    EXPECT_GT(s.shown.samples[i].t, 0);
    EXPECT_LT(i + 5, s.shown.samples.size()) << "time to recover";
  }
  EXPECT_EQ(covered, 4);
  s.eyes->Show(0);
  EXPECT_GT(s.stage.VisibleCaps(0)[kIndex], 0.5) << "and is gone before";
}

TEST(SimulatedEyesTest, ClutterStandsBehindTheHand) {
  Scene scene = PinchScene();
  Setup bare(scene);
  scene.demonstrator.clutter = 8;
  Setup full(scene);
  const StereoFrame a = bare.eyes->Look(bare.middle()), b = full.eyes->Look(full.middle());
  cv::Mat change;
  cv::absdiff(a.left, b.left, change);
  cv::cvtColor(change, change, cv::COLOR_BGR2GRAY);
  EXPECT_GT(cv::countNonZero(change > 20), 640 * 480 / 20);
  const PerFinger<double> before = bare.stage.VisibleCaps(0), now = full.stage.VisibleCaps(0);
  for (int f = 0; f < kNumFingers; ++f) EXPECT_NEAR(before[f], now[f], 0.02) << kFingerNames[f];
}

TEST(SimulatedEyesTest, ACalibrationErrorIsToldToTheTrackerOnly) {
  Scene scene = PinchScene();
  scene.eyes.calibration_error.rotation = 0.003;
  scene.eyes.calibration_error.focal = 0.01;
  Setup s(scene);
  const StereoCameras &truth = s.stage.eyes(), &told = s.eyes->told();
  EXPECT_NEAR(told.left.fx, 1.01 * truth.left.fx, 1e-9);
  EXPECT_EQ(told.left.X_WC.matrix(), truth.left.X_WC.matrix());
  const Eigen::Matrix3d turn = truth.right.X_WC.linear().transpose() * told.right.X_WC.linear();
  EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), 0.003, 1e-9);
  EXPECT_TRUE(Same(s.eyes->Look(0).right, Setup(PinchScene()).eyes->Look(0).right));
}

TEST(SimulatedEyesTest, EffectsDrawFromStreamsOfTheirOwn) {
  const RandomEngine engine = MakeStream(1, 0, "observation");
  RandomEngine same = engine;
  RandomEngine a = SubStream(engine, "noise"), b = SubStream(engine, "noise"),
               c = SubStream(engine, "drops");
  EXPECT_EQ(engine, same);
  EXPECT_EQ(a, b);
  EXPECT_NE(a(), c());
}

}  // namespace
}  // namespace springgrasp
