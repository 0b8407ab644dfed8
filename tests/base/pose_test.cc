#include "base/pose.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "base/error.h"

namespace springgrasp {
namespace {

Pose QuarterTurnAtX(double x) {
  return MakePose({x, 0, 0}, ExpRotation({0, 0, std::numbers::pi / 2}));
}

TEST(PoseTest, ArraysComeBackWithPositiveW) {
  const Pose X = MakePose({1, 2, 3}, Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5));
  const Eigen::Matrix<double, 7, 1> a = PoseToArray(X);
  EXPECT_GE(a[3], 0);
  EXPECT_TRUE(PoseFromArray(a.data()).isApprox(X));
}

TEST(PoseTest, RotationVectorsComeBack) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d w =
        1.8 * Eigen::Vector3d(coordinate(engine), coordinate(engine), coordinate(engine));
    EXPECT_TRUE(LogRotation(ExpRotation(w)).isApprox(w, 1e-9));  // |w| < 3.12
  }
}

TEST(PoseTest, HalfWayIsHalfTheShiftAndHalfTheTurn) {
  const Pose X = Interpolate(Pose::Identity(), QuarterTurnAtX(1), 0.5);
  EXPECT_TRUE(X.isApprox(MakePose({0.5, 0, 0}, ExpRotation({0, 0, std::numbers::pi / 4}))));
}

TEST(PoseTest, PathsGoThroughTheirSamplesAndStayAtTheirEnds) {
  const std::vector<Pose> path = {Pose::Identity(), QuarterTurnAtX(1), QuarterTurnAtX(3)};
  EXPECT_TRUE(PoseAlong(path, 1).isApprox(path[1]));
  EXPECT_TRUE(PoseAlong(path, 1.5).isApprox(QuarterTurnAtX(2)));
  EXPECT_TRUE(PoseAlong(path, -1).isApprox(path.front()));
  EXPECT_TRUE(PoseAlong(path, 7).isApprox(path.back()));
}

TEST(PoseTest, FramesKeepTheirXAndLeanTowardsTheirZ) {
  const Eigen::Matrix3d R = FrameFromXZ({2, 0, 0}, {1, 0, 1});
  EXPECT_TRUE(R.isApprox(Eigen::Matrix3d::Identity()));
  EXPECT_THROW(FrameFromXZ({0, 0, 0}, {0, 0, 1}), Error);
  EXPECT_THROW(FrameFromXZ({0, 0, 1}, {0, 0, 2}), Error);
}

}  // namespace
}  // namespace springgrasp
