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
struct Watched {
  explicit Watched(const Scene& scene, double fps = 20)
      : stage(scene, std::nullopt), engine(MakeStream(3, 0, "observation")) {
    motion = PrepareDemonstration(scene, stage, engine);
    shown = Resampled(motion, fps);
    eyes.emplace(stage, stage.eyes_settings(), motion, shown, engine);
  }
  std::size_t middle() const { return shown.samples.size() / 2; }
  Eigen::Vector3d Tip(std::size_t frame, int finger) const {
    const HandMotionSample& sample = shown.samples[frame];
    return sample.X_WH * ComputeHandShape(stage.hand(), sample.q).tips[finger];
  }

  ObserveStage stage;
  RandomEngine engine;
  HandMotion motion, shown;
  std::optional<SimulatedEyes> eyes;
};

// Middle of the green within 20 px (of a picture 480 px high) of a place, each pixel weighted by
// how green it is.
Eigen::Vector2d GreenNear(const cv::Mat& bgr, const Eigen::Vector2d& place) {
  const double reach = 20 * bgr.rows / 480.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double weight = 0;
  for (int v = 0; v < bgr.rows; ++v) {
    for (int u = 0; u < bgr.cols; ++u) {
      if ((Eigen::Vector2d(u, v) - place).norm() > reach) continue;
      const cv::Vec3b& pixel = bgr.at<cv::Vec3b>(v, u);
      const int green = std::max(0, pixel[1] - std::max(pixel[0], pixel[2]) - 30);
      sum += green * Eigen::Vector2d(u, v);
      weight += green;
    }
  }
  EXPECT_GT(weight, 1000) << "a cap is there";
  return sum / weight;
}

bool Same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

TEST(SimulatedEyesTest, AreIdealWhereNothingIsAskedFor) {
  Watched s(PinchScene());
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
  Watched straight(scene);
  scene.eyes.distortion = {-0.25, 0.08, 0.002, -0.001, 0};
  Watched bent(scene);
  const StereoFrame a = straight.eyes->Look(0), b = bent.eyes->Look(0);
  double largest = 0;
  for (const int f : {kThumb, kPinkie}) {  // the caps with no other within 20 px
    for (int eye = 0; eye < 2; ++eye) {
      const CameraModel& pinhole = straight.stage.eyes().view(eye);
      const CameraModel& lens = bent.stage.eyes().view(eye);
      const Eigen::Vector3d tip = straight.Tip(0, f);
      const Eigen::Vector2d seen = GreenNear(eye == 0 ? a.left : a.right, *Project(pinhole, tip));
      const Eigen::Vector3d p_W = pinhole.X_WC.translation() + PixelRay(pinhole, seen);
      const Eigen::Vector2d expected = *Project(lens, p_W);
      const Eigen::Vector2d bowed = GreenNear(eye == 0 ? b.left : b.right, *Project(lens, tip));
      EXPECT_LT((bowed - expected).norm(), 0.25) << kFingerNames[f];
      largest = std::max(largest, (expected - seen).norm());
    }
  }
  EXPECT_GT(largest, 2) << "the lens moves things";
}

// Every pixel of the distorted picture, to the hundredth.
TEST(SimulatedEyesTest, TheLensIsThatOfTheCameraModel) {
  Scene scene = PinchScene();
  scene.eyes.distortion = {-0.25, 0.08, 0.002, -0.001, 0.01};
  const ObserveStage stage(scene, std::nullopt);
  CameraModel camera = stage.eyes().left;
  camera.X_WC = Pose::Identity();
  const double fovy_deg = 2 * std::atan(camera.height / (2 * camera.fy)) * 180 / M_PI;
  const LensView lens = MakeLensView(camera.width, camera.height, fovy_deg, scene.eyes.distortion);
  for (int v = 0; v < camera.height; v += 37) {
    for (int u = 0; u < camera.width; u += 41) {
      const Eigen::Vector3d ray = PixelRay(camera, Eigen::Vector2d(u, v));
      EXPECT_NEAR(lens.map_x.at<float>(v, u),
                  camera.fx * ray.x() / ray.z() + (lens.width - 1) / 2.0, 0.01);
      EXPECT_NEAR(lens.map_y.at<float>(v, u),
                  camera.fy * ray.y() / ray.z() + (lens.height - 1) / 2.0, 0.01);
    }
  }
}

TEST(SimulatedEyesTest, PicturesAreAsLargeAsAskedAndSeeTheSame) {
  Scene scene = PinchScene();
  Watched usual(scene);
  scene.eyes.width = 1280;
  scene.eyes.height = 960;
  Watched large(scene);
  const StereoFrame a = usual.eyes->Look(0), b = large.eyes->Look(0);
  ASSERT_EQ(b.left.size(), cv::Size(1280, 960));
  const Eigen::Vector3d tip = usual.Tip(0, kThumb);
  const Eigen::Vector2d small = GreenNear(a.left, *Project(usual.stage.eyes().left, tip));
  const Eigen::Vector2d big = GreenNear(b.left, *Project(large.stage.eyes().left, tip));
  EXPECT_LT((big - (2 * small + Eigen::Vector2d(0.5, 0.5))).norm(), 0.5);
}

TEST(SimulatedEyesTest, AnExposureSmearsAboutItsMiddle) {
  Scene scene = PinchScene();
  scene.demonstrator.speed = 1;
  Watched sharp(scene, 60);
  scene.eyes.exposure = 0.01;
  Watched smeared(scene, 60);
  const std::size_t frame = 50;
  const StereoFrame a = sharp.eyes->Look(frame), b = smeared.eyes->Look(frame);
  const Eigen::Vector2d at = *Project(sharp.stage.eyes().left, sharp.Tip(frame, kThumb));
  EXPECT_LT((GreenNear(a.left, at) - GreenNear(b.left, at)).norm(), 1);
  cv::Mat change;
  cv::absdiff(a.left, b.left, change);
  EXPECT_GT(cv::norm(change, cv::NORM_INF), 50) << "edges are smeared";
  // At rest nothing is.
  const std::size_t last = sharp.shown.samples.size() - 1;
  EXPECT_TRUE(Same(sharp.eyes->Look(last).left, smeared.eyes->Look(last).left));
}

TEST(SimulatedEyesTest, TheRightEyeMayBeLate) {
  Scene scene = PinchScene();
  scene.eyes.time_offset = 0.02;
  Watched s(scene);
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
  Watched s(scene, 200);
  int dropped = 0;
  for (std::size_t i = 0; i < s.shown.samples.size(); ++i) dropped += s.eyes->IsDropped(i);
  const double share = dropped / double(s.shown.samples.size());
  EXPECT_NEAR(share, 0.3, 0.1);
  EXPECT_FALSE(s.eyes->IsDropped(0));
}

TEST(SimulatedEyesTest, LightAndWhiteBalanceDrift) {
  Scene scene = PinchScene();
  scene.eyes.brightness_drift = 0.4;
  Watched light(scene, 10);
  scene.eyes.brightness_drift = 0;
  scene.eyes.white_balance_drift = 0.3;
  Watched white(scene, 10);
  Watched plain(PinchScene(), 10);
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
  Watched s(scene);
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
  Watched bare(scene);
  scene.demonstrator.clutter = 8;
  Watched full(scene);
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
  Watched s(scene);
  const StereoCameras &truth = s.stage.eyes(), &told = s.eyes->told();
  EXPECT_NEAR(told.left.fx, 1.01 * truth.left.fx, 1e-9);
  EXPECT_EQ(told.left.X_WC.matrix(), truth.left.X_WC.matrix());
  const Eigen::Matrix3d turn = truth.right.X_WC.linear().transpose() * told.right.X_WC.linear();
  EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), 0.003, 1e-9);
  EXPECT_TRUE(Same(s.eyes->Look(0).right, Watched(PinchScene()).eyes->Look(0).right));
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
