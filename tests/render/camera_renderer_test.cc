#include "render/camera_renderer.h"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "base/error.h"
#include "base/random.h"
#include "render/camera_geometry.h"
#include "sim/model_index.h"
#include "sim/sim_fixture.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

// One bright ball that can be put anywhere, one occluder, one camera that looks along +y.
constexpr const char* kBallWorld = R"(
  <mujoco><compiler angle="radian" autolimits="true"/>
    <visual><global offwidth="640" offheight="480"/><quality offsamples="0"/></visual>
    <statistic extent="2" center="0 0 1"/>
    <worldbody>
      <camera name="eye" pos="0.05 -0.1 1.2" xyaxes="0.98 0.199 0 -0.02 0.1 0.99" fovy="47.88"/>
      <body name="ball" mocap="true" pos="0 1 1"><geom name="ball" size="0.03" rgba="1 1 1 1"/></body>
      <body name="wall" mocap="true" pos="0 9 1">
        <geom name="wall" type="box" size="0.2 0.001 0.2" rgba="0.1 0.1 0.9 1"/></body>
      <geom name="floor" type="plane" size="9 9 1" rgba="0 0 0 1"/>
    </worldbody></mujoco>)";

Eigen::Vector2d Centroid(const cv::Mat& mask) {
  const cv::Moments m = cv::moments(mask, true);
  return {m.m10 / m.m00, m.m01 / m.m00};
}

TEST(CameraRendererTest, SphereIsSeenWhereItProjectsTo) {
  Simulation sim(LoadModelText(kBallWorld, "ball"));
  CameraRenderer renderer(sim.model());
  const int ball = IdOf(sim.model(), mjOBJ_GEOM, "ball");
  const Eigen::Matrix3d K = PinholeMatrix(CameraFovyDeg(sim.model(), "eye"), 640, 480);
  RandomEngine engine = MakeStream(5, 0, "spheres");
  for (int i = 0; i < 30; ++i) {
    sim.Forward();
    const Pose X_WC = CameraPose(sim.model(), sim.data(), "eye");
    const double depth = Uniform(engine, 0.5, 1.2);
    const Eigen::Vector3d p_CB(depth * Uniform(engine, -0.4, 0.4),
                               depth * Uniform(engine, -0.3, 0.3), depth);
    const Eigen::Vector3d p_WB = X_WC * p_CB;
    sim.PlaceBody("ball", MakePose(p_WB, Eigen::Quaterniond::Identity()));
    sim.Forward();
    const cv::Mat seen = renderer.Segmentation(sim.data(), CameraView::Named("eye")) == ball;
    const Eigen::Vector3d expected = ProjectToPixel(K, X_WC, p_WB);
    EXPECT_NEAR(expected.z(), depth, 1e-9);
    // A sphere off the axis is seen as an ellipse whose centre lies outside of the projected
    // centre by this factor (a cone cut by the picture plane).
    const double r2 = 0.03 * 0.03;
    const double stretch = depth * depth / (depth * depth - r2);
    const Eigen::Vector2d centre(K(0, 2) + (expected.x() - K(0, 2)) * stretch,
                                 K(1, 2) + (expected.y() - K(1, 2)) * stretch);
    EXPECT_LT((Centroid(seen) - centre).norm(), 0.3) << i;
    // The free camera at the same place sees the same.
    const cv::Mat free = renderer.Segmentation(sim.data(), CameraView::Free(X_WC, 47.88)) == ball;
    EXPECT_LE(cv::countNonZero(free != seen), 2);
  }
}

TEST(CameraRendererTest, ColourDepthAndSegmentationAgree) {
  Simulation sim(LoadModelText(kBallWorld, "ball"));
  CameraRenderer renderer(sim.model());
  sim.Forward();
  const Pose X_WC = CameraPose(sim.model(), sim.data(), "eye");
  const Eigen::Vector3d p_WB = X_WC * Eigen::Vector3d(0.1, -0.08, 0.9);
  sim.PlaceBody("ball", MakePose(p_WB, Eigen::Quaterniond::Identity()));
  sim.Forward();
  const CameraView eye = CameraView::Named("eye");
  const cv::Mat seen =
      renderer.Segmentation(sim.data(), eye) == IdOf(sim.model(), mjOBJ_GEOM, "ball");
  cv::Mat grey, bright;
  cv::cvtColor(renderer.Bgr(sim.data(), eye), grey, cv::COLOR_BGR2GRAY);
  ASSERT_GT(cv::countNonZero(seen), 500);
  const Eigen::Vector2d c = Centroid(seen);
  const cv::Point middle(static_cast<int>(std::lround(c.x())),
                         static_cast<int>(std::lround(c.y())));
  EXPECT_LT(middle.y, 240);  // above the middle: the first row is on top
  EXPECT_GT(middle.x, 320);
  EXPECT_GT(grey.at<unsigned char>(middle), 60);
  // The nearest point of the sphere lies on the ray to its centre.
  const Eigen::Vector3d p_CB(0.1, -0.08, 0.9);
  const double nearest = p_CB.z() * (1 - 0.03 / p_CB.norm());
  EXPECT_NEAR(renderer.Depth(sim.data(), eye).at<float>(middle), nearest, 1e-3);
}

TEST(CameraRendererTest, VisibleFractionCountsWhatIsHidden) {
  Simulation sim(LoadModelText(kBallWorld, "ball"));
  CameraRenderer renderer(sim.model());
  sim.Forward();
  const Pose X_WC = CameraPose(sim.model(), sim.data(), "eye");
  const int ball = IdOf(sim.model(), mjOBJ_GEOM, "ball");
  const CameraView eye = CameraView::Named("eye");
  const auto fraction = [&](double wall_x) {
    sim.PlaceBody("ball", X_WC * Pose(Eigen::Translation3d(0, 0, 0.9)));
    // Half of the wall's width beside its middle: its edge lies at wall_x before the ball.
    sim.PlaceBody("wall", X_WC * Pose(Eigen::Translation3d(wall_x + 0.2, 0, 0.6)) *
                              Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitX()));
    sim.Forward();
    return renderer.CountVisible(sim.data(), eye, {ball}).front();
  };
  EXPECT_EQ(fraction(0.3).fraction(), 1);
  EXPECT_NEAR(fraction(0.0).fraction(), 0.5, 0.02);
  EXPECT_EQ(fraction(-0.2).visible, 0);
  EXPECT_GT(fraction(-0.2).unoccluded, 500);
}

TEST(CameraRendererTest, SeveralModelsShareTheContextAndGiveTheSamePixelsAgain) {
  Simulation ball(LoadModelText(kBallWorld, "ball"));
  Simulation scene(BuildModel(TestScene()));
  CameraRenderer first(ball.model());
  CameraRenderer second(scene.model());
  const cv::Mat before = first.Bgr(ball.data(), CameraView::Named("eye"));
  const cv::Mat other = second.Bgr(scene.data(), CameraView::Named("eye_l_wide"));
  const cv::Mat after = first.Bgr(ball.data(), CameraView::Named("eye"));
  EXPECT_EQ(cv::norm(before, after, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(before, other, cv::NORM_INF), 0);
}

TEST(CameraRendererTest, ThreadsTakeTurns) {
  std::vector<cv::Mat> first(2), second(2);
  const auto draw = [](cv::Mat& a, cv::Mat& b) {
    Simulation sim(BuildModel(TestScene()));
    CameraRenderer renderer(sim.model());
    a = renderer.Bgr(sim.data(), CameraView::Named("front"));
    for (int i = 0; i < 5; ++i) renderer.Bgr(sim.data(), CameraView::Named("eye_l_wide"));
    b = renderer.Bgr(sim.data(), CameraView::Named("front"));
  };
  std::thread other([&] { draw(first[1], second[1]); });
  draw(first[0], second[0]);
  other.join();
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(cv::norm(first[0], first[i], cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(first[0], second[i], cv::NORM_INF), 0);
  }
}

TEST(CameraRendererTest, LeavingOutTheUnseenChangesNoPixel) {
  Simulation sim(BuildModel(TestScene()));
  // Reflections switch the leaving out off; nothing in the scene reflects.
  RenderOptions all;
  all.reflections = true;
  CameraRenderer fast(sim.model()), complete(sim.model(), all);
  RandomEngine engine = MakeStream(9, 0, "views");
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d from(Uniform(engine, -1, 1), Uniform(engine, 0, 2),
                               Uniform(engine, 0.5, 2));
    const Eigen::Vector3d to(Uniform(engine, -1, 1), Uniform(engine, 0, 1), 1);
    const CameraView view = CameraView::Free(LookAtPose(from, to), 47.88);
    EXPECT_EQ(cv::norm(fast.Segmentation(sim.data(), view), complete.Segmentation(sim.data(), view),
                       cv::NORM_INF),
              0);
  }
}

TEST(CameraRendererTest, StereoEyesSeeAPointAtItsDisparity) {
  Simulation sim(BuildModel(TestScene()));
  const Pose X_WL = CameraPose(sim.model(), sim.data(), "eye_l_wide");
  const Pose X_WR = CameraPose(sim.model(), sim.data(), "eye_r_wide");
  EXPECT_NEAR((X_WL.inverse() * X_WR.translation()).x(), 0.093, 1e-9);
  const Eigen::Matrix3d K = PinholeMatrix(47.88, 640, 480);
  EXPECT_NEAR(K(0, 0), 540.5, 0.5);
  const Eigen::Vector3d p_W = X_WL * Eigen::Vector3d(0.03, 0.02, 0.6);
  const double disparity = ProjectToPixel(K, X_WL, p_W).x() - ProjectToPixel(K, X_WR, p_W).x();
  EXPECT_NEAR(disparity, K(0, 0) * 0.093 / 0.6, 1e-6);
}

TEST(CameraRendererTest, MarksAreDrawn) {
  Simulation sim(LoadModelText(kBallWorld, "ball"));
  CameraRenderer renderer(sim.model());
  sim.Forward();
  const CameraView eye = CameraView::Named("eye");
  Mark arrow;
  arrow.kind = Mark::Kind::kArrow;
  arrow.p_W = {0, 1, 1.2};
  arrow.to_W = {0.1, 1, 1.3};
  const cv::Mat without = renderer.Bgr(sim.data(), eye);
  const cv::Mat with = renderer.Bgr(sim.data(), eye, {arrow});
  EXPECT_GT(cv::norm(without, with, cv::NORM_INF), 50);
}

TEST(CameraRendererTest, BadRequestsAreErrors) {
  Simulation sim(LoadModelText(kBallWorld, "ball"));
  RenderOptions large;
  large.width = 4000;
  EXPECT_THROW(CameraRenderer(sim.model(), large), Error);
  CameraRenderer renderer(sim.model());
  EXPECT_THROW(renderer.Bgr(sim.data(), CameraView::Named("nose")), Error);
}

TEST(CameraRendererTest, PictureOfAnyModelShowsSomething) {
  const cv::Mat picture = PictureOf(*BuildModel(TestScene()), 320, 240);
  EXPECT_EQ(picture.size(), cv::Size(320, 240));
  cv::Scalar mean, deviation;
  cv::meanStdDev(picture, mean, deviation);
  EXPECT_GT(deviation[0], 5);
}

}  // namespace
}  // namespace springgrasp
