#include "vision/cap_fit.h"

#include <gtest/gtest.h>

#include "vision/synthetic_caps.h"

namespace springgrasp {
namespace {

const CapShape kShape = {kCapRadius, kCapLength, 0};

// Fit of a cap at `tip` along `axis` on a finger, optionally with something in front of it.
std::optional<CapFit> FitOf(const Eigen::Vector3d& tip, const Eigen::Vector3d& axis,
                            const Eigen::Vector3d& guess_axis, bool hidden) {
  const StereoCameras eyes = TestEyes();
  const double half = kShape.front();
  std::vector<DrawnCapsule> scene = {
      {tip - half * axis, tip + half * axis, kCapRadius, {20, 160, 20}},
      {tip - 0.004 * axis, tip - 0.04 * axis, 0.0078, kSkin}};
  if (hidden) {
    // A red bar over about a third of the cap, from the side.
    const Eigen::Vector3d beside = tip + Eigen::Vector3d(0.010, 0, -0.03);
    scene.push_back({beside + Eigen::Vector3d(0, -0.05, 0),
                     beside + Eigen::Vector3d(0, 0.05, 0),
                     0.006,
                     {30, 30, 200}});
  }
  std::array<CapContour, 2> contours;
  const MarkerColour colour = MakeMarkerColour({});
  for (int v = 0; v < 2; ++v) {
    const cv::Mat picture = DrawCapsules(eyes.view(v), scene);
    const Eigen::Vector3d inside = hidden ? tip + Eigen::Vector3d(-0.003, 0, 0) : tip;
    contours[v] = TraceCap(picture, colour, *Project(eyes.view(v), inside), 24);
  }
  return FitCap(eyes, contours, kShape, tip + Eigen::Vector3d(0.003, -0.002, 0.008), guess_axis);
}

TEST(CapFitTest, TheOutlineIsTracedToATenthOfAPixel) {
  CameraModel camera;
  const Eigen::Vector3d p_W(0.013, -0.021, 0.6);
  const cv::Mat picture = DrawCapsules(camera, {{p_W, p_W, kCapRadius, {20, 160, 20}}});
  const Eigen::Vector2d centre = *Project(camera, p_W);
  const CapContour contour =
      TraceCap(picture, MakeMarkerColour({}), centre + Eigen::Vector2d(0.8, -0.6), 20);
  EXPECT_GE(contour.count, kContourRays - 2);
  double mean = 0;
  const double radius = camera.fx * kCapRadius / 0.6;
  for (int k = 0; k < kContourRays; ++k) {
    if (!contour.valid[k]) continue;
    EXPECT_NEAR((contour.point[k] - centre).norm(), radius, 0.35);
    mean += (contour.point[k] - centre).norm() / contour.count;
  }
  EXPECT_NEAR(mean, radius, 0.1);
}

TEST(CapFitTest, TheCentreOfAnElongatedCapIsFoundFromAllSides) {
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, -0.3, -0.3),
        Eigen::Vector3d(-0.5, -0.5, -0.6)}) {
    const Eigen::Vector3d tip(0.02, -0.03, 0.6), axis = direction.normalized();
    const Eigen::Vector3d guess = (axis + Eigen::Vector3d(0.15, 0.1, -0.1)).normalized();
    const auto fit = FitOf(tip, axis, guess, false);
    ASSERT_TRUE(fit) << direction.transpose();
    EXPECT_LT((fit->p_W - tip).norm(), 0.003) << direction.transpose();
    // Across the line of sight it is far better.
    EXPECT_LT((fit->p_W - tip).head<2>().norm(), 0.0012) << direction.transpose();
  }
}

TEST(CapFitTest, WhatHidesAPartOfTheCapDoesNotPullTheCentre) {
  const Eigen::Vector3d tip(0.02, -0.03, 0.6), axis(0, -1, 0);
  const auto fit = FitOf(tip, axis, axis, true);
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->p_W - tip).norm(), 0.004);
  EXPECT_LT(std::max(fit->agreement[0], fit->agreement[1]), 0.95);
}

TEST(CapFitTest, TooLittleOutlineIsNoFit) {
  std::array<CapContour, 2> contours;
  EXPECT_FALSE(FitCap(TestEyes(), contours, kShape, {0, 0, 0.6}, {0, -1, 0}));
}

TEST(CapShapeTest, DefaultsAreAThimble) {
  EXPECT_DOUBLE_EQ((CapShape{0.01, 0, 0}).full_length(), 0.025);
  EXPECT_DOUBLE_EQ((CapShape{0.01, 0.02, 0}).front(), 0);
  EXPECT_DOUBLE_EQ((CapShape{0.01, 0.03, 0}).back(), -0.005);
}

}  // namespace
}  // namespace springgrasp
