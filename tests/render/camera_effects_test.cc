#include "render/camera_effects.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/error.h"

namespace springgrasp {
namespace {

cv::Mat Plain(int grey, int width = 64, int height = 48) {
  return {height, width, CV_8UC3, cv::Scalar(grey, grey, grey)};
}

TEST(LensTest, WithoutDistortionPixelsStayWhereTheyAre) {
  const LensView lens = MakeLensView(64, 48, 48, {});
  cv::Mat ideal(lens.height, lens.width, CV_8UC3);
  cv::randu(ideal, 0, 255);
  const cv::Mat seen = Distorted(lens, ideal);
  ASSERT_EQ(seen.size(), cv::Size(64, 48));
  const int x = (lens.width - 64) / 2, y = (lens.height - 48) / 2;
  EXPECT_LE(cv::norm(seen, ideal(cv::Rect(x, y, 64, 48)), cv::NORM_INF), 1);
}

TEST(LensTest, ABarrelSeesMoreThanAPinholeAndACushionLess) {
  const LensView barrel = MakeLensView(640, 480, 48, {-0.25, 0.08, 0, 0, 0});
  const LensView cushion = MakeLensView(640, 480, 48, {0.2, 0, 0, 0, 0});
  EXPECT_GT(barrel.width, 660);
  EXPECT_LT(cushion.width, 620);
  EXPECT_GT(barrel.fovy_deg, 48);
  EXPECT_LT(cushion.fovy_deg, 48);
}

TEST(LensTest, ALensThatFoldsThePictureIsAnError) {
  EXPECT_THROW(MakeLensView(640, 480, 48, {-1.5, 0, 0, 0, 0}), Error);
}

TEST(ExposureTest, SubframesLieEvenlyAboutTheMiddle) {
  const std::vector<double> times = SubframeTimes(0.01, 4);
  ASSERT_EQ(times.size(), 4u);
  EXPECT_NEAR(times.front(), -0.00375, 1e-12);
  EXPECT_NEAR(times.back(), 0.00375, 1e-12);
  EXPECT_NEAR(times[2] - times[1], 0.0025, 1e-12);
}

TEST(ExposureTest, TheMeanIsThatOfThePictures) {
  PictureMean mean;
  for (const int grey : {10, 20, 60}) mean.Add(Plain(grey));
  EXPECT_EQ(cv::norm(mean.Mean(), Plain(30), cv::NORM_INF), 0);
}

TEST(GainTest, DriftSpansItsRangeOverASequence) {
  double low = 9, high = 0, jump = 0;
  for (int i = 0; i <= 100; ++i) {
    const double gain = DriftGain(0.4, i / 100.0, 0.3);
    low = std::min(low, gain);
    high = std::max(high, gain);
    jump = std::max(jump, std::abs(gain - DriftGain(0.4, (i + 1) / 100.0, 0.3)));
  }
  EXPECT_NEAR(high - low, 0.4, 1e-3);
  EXPECT_NEAR(high + low, 2, 1e-3);
  EXPECT_LT(jump, 0.013) << "smooth";
  EXPECT_EQ(DriftGain(0, 0.7, 0.3), 1);
}

TEST(GainTest, ChannelsAreMultipliedAndTooBrightIsWhite) {
  cv::Mat bgr(2, 2, CV_8UC3, cv::Scalar(100, 200, 50));
  ApplyGains(bgr, {0.5, 1.5, 1});
  EXPECT_EQ(bgr.at<cv::Vec3b>(1, 1), cv::Vec3b(50, 255, 50));
}

TEST(NoiseTest, HasTheAskedDeviationAndNoMean) {
  RandomEngine engine = MakeStream(1, 0, "noise");
  const PictureNoise noise(6, engine);
  cv::Mat bgr = Plain(128, 640, 480);
  noise.AddTo(bgr, engine);
  cv::Scalar mean, deviation;
  cv::meanStdDev(bgr, mean, deviation);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], 128, 0.1);
    EXPECT_NEAR(deviation[c], 6, 0.1);
  }
}

TEST(NoiseTest, NoneChangesNothingAndDrawsNothing) {
  RandomEngine engine = MakeStream(1, 0, "noise"), untouched = engine;
  const PictureNoise noise(0, engine);
  cv::Mat bgr = Plain(128);
  noise.AddTo(bgr, engine);
  EXPECT_EQ(cv::norm(bgr, Plain(128), cv::NORM_INF), 0);
  EXPECT_EQ(engine, untouched);
}

}  // namespace
}  // namespace springgrasp
