#include "base/shape_ray.h"

#include <gtest/gtest.h>

#include <cmath>

namespace springgrasp {
namespace {

using Eigen::Vector3d;

constexpr const char* kShapes[] = {"box:0.04x0.06x0.1", "cylinder:0.05x0.1", "sphere:0.04"};

TEST(RayThroughTest, SpansTheShape) {
  const Vector3d from(-1, 0.004, 0.01);
  const double half_width[] = {0.02, std::sqrt(0.025 * 0.025 - 0.004 * 0.004),
                               std::sqrt(0.02 * 0.02 - 0.004 * 0.004 - 0.01 * 0.01)};
  for (int i = 0; i < 3; ++i) {
    const auto span = RayThrough(ParseShape(kShapes[i]), from, Vector3d::UnitX());
    ASSERT_TRUE(span) << kShapes[i];
    EXPECT_NEAR(span->enter, 1 - half_width[i], 1e-12);
    EXPECT_NEAR(span->leave, 1 + half_width[i], 1e-12);
  }
  const auto down = RayThrough(ParseShape("cylinder:0.05x0.18"), {0.01, 0, 1}, -Vector3d::UnitZ());
  ASSERT_TRUE(down);
  EXPECT_NEAR(down->enter, 1 - 0.09, 1e-12);
}

TEST(RayThroughTest, BeginsAtItsOriginWhereThatIsInside) {
  for (const char* shape : kShapes) {
    const auto span = RayThrough(ParseShape(shape), Vector3d::Zero(), Vector3d::UnitX());
    ASSERT_TRUE(span) << shape;
    EXPECT_EQ(span->enter, 0);
    EXPECT_NEAR(span->leave, 0.5 * ParseShape(shape).size.x(), 1e-12);
  }
}

TEST(RayThroughTest, MissesWhatIsBesideOrBehind) {
  for (const char* shape : kShapes) {
    EXPECT_FALSE(RayThrough(ParseShape(shape), {-1, 0.2, 0}, Vector3d::UnitX())) << shape;
    EXPECT_FALSE(RayThrough(ParseShape(shape), {-1, 0, 0.2}, Vector3d::UnitX())) << shape;
    EXPECT_FALSE(RayThrough(ParseShape(shape), {1, 0, 0}, Vector3d::UnitX())) << shape;
  }
}

}  // namespace
}  // namespace springgrasp
