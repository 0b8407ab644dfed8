#include "vision/object_depth.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

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
