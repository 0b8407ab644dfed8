#include "vision/object_depth.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

TEST(RayToShapeTest, MeetsTheNearSurface) {
  const Eigen::Vector3d from(-1, 0.004, 0.01), along = Eigen::Vector3d::UnitX();
  EXPECT_NEAR(*RayToShape(ParseShape("box:0.04x0.06x0.1"), from, along), 1 - 0.02, 1e-12);
  EXPECT_NEAR(*RayToShape(ParseShape("cylinder:0.05x0.18"), from, along),
              1 - std::sqrt(0.025 * 0.025 - 0.004 * 0.004), 1e-12);
  EXPECT_NEAR(*RayToShape(ParseShape("sphere:0.04"), from, along),
              1 - std::sqrt(0.02 * 0.02 - 0.004 * 0.004 - 0.01 * 0.01), 1e-12);
  const Eigen::Vector3d above(0.01, 0, 1);
  EXPECT_NEAR(*RayToShape(ParseShape("cylinder:0.05x0.18"), above, -Eigen::Vector3d::UnitZ()),
              1 - 0.09, 1e-12);
}

TEST(RayToShapeTest, MissesWhatIsBesideOrBehind) {
  for (const char* shape : {"box:0.04x0.06x0.1", "cylinder:0.05x0.1", "sphere:0.04"}) {
    const Eigen::Vector3d along = Eigen::Vector3d::UnitX();
    EXPECT_FALSE(RayToShape(ParseShape(shape), {-1, 0.2, 0}, along)) << shape;
    EXPECT_FALSE(RayToShape(ParseShape(shape), {-1, 0, 0.2}, along)) << shape;
    EXPECT_FALSE(RayToShape(ParseShape(shape), {1, 0, 0}, along)) << shape;
  }
}

TEST(SeeObjectTest, CoversThePixelsOfItsPoints) {
  const CameraModel camera;  // in the origin, looking along z
  DemonstratedObject object{ParseShape("sphere:0.1"), Pose::Identity()};
  object.X_WO.translation() = Eigen::Vector3d(0.05, -0.02, 0.7);
  const ObjectDepth seen = SeeObject(camera, object);
  const Eigen::Vector2d middle = *Project(camera, object.X_WO.translation());
  EXPECT_NEAR(seen.At(middle), 0.65, 0.001);
  const double radius = camera.fx * 0.05 / 0.7;
  EXPECT_TRUE(seen.Covers(middle + Eigen::Vector2d(0.9 * radius, 0)));
  EXPECT_FALSE(seen.Covers(middle + Eigen::Vector2d(1.15 * radius, 0)));
  EXPECT_FALSE(seen.Covers({-50, 10}));
}

}  // namespace
}  // namespace springgrasp
