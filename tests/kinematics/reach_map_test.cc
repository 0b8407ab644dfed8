#include "kinematics/reach_map.h"

#include <gtest/gtest.h>

#include "test_arm.h"

namespace springgrasp {
namespace {

// A point between thumb and fingers.
const Eigen::Vector3d kGrasp(0.13, 0.0, -0.05);

int Side(const Eigen::Vector3d& p_WG, const ReachSurroundings& around = {}) {
  return CountDirections(TestArm(), TestRobotHand(), kGrasp, p_WG, Approach::kSide, around);
}
int Above(const Eigen::Vector3d& p_WG, const ReachSurroundings& around = {}) {
  return CountDirections(TestArm(), TestRobotHand(), kGrasp, p_WG, Approach::kAbove, around);
}

TEST(ReachMapTest, KnowsTheWindowsOfTheArm) {
  EXPECT_GT(Side({0.35, 0.5, 1.1}), 0);
  EXPECT_GT(Above({0.35, 0.5, 0.9}), 0);
  EXPECT_EQ(Side({0.35, 1.3, 1.1}), 0) << "too far";
  EXPECT_EQ(Side({0.35, 0.5, 0.3}), 0) << "too low";
}

TEST(ReachMapTest, ATableTakesDirectionsAway) {
  ReachSurroundings table;
  table.table_height = 0.95;
  int free = 0, above_it = 0;
  for (const double y : {0.4, 0.5, 0.6}) {
    const Eigen::Vector3d p(0.35, y, 0.96);
    free += Above(p) + Side(p);
    above_it += Above(p, table) + Side(p, table);
  }
  EXPECT_LT(above_it, free);
}

TEST(ReachMapTest, AMapIsItsCellsAndItsText) {
  ReachMapOptions options;
  options.cell = 0.2;
  options.directions = 4;
  const ReachMap map = MakeReachMap(TestArm(), TestRobotHand(), kGrasp, 1.05, {}, options);
  ASSERT_EQ(map.columns, 5);
  ASSERT_EQ(map.rows, 4);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(map.side[i], CountDirections(TestArm(), TestRobotHand(), kGrasp,
                                           {options.x_from + 0.2 * (i % 5),
                                            options.y_from + 0.2 * (i / 5), 1.05},
                                           Approach::kSide, {}, options));
  }
  const std::string text =
      FormatReachMap(map, {0, 1, 2, 3, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, options);
  EXPECT_NE(text.find(" . 2 5 7 #"), std::string::npos) << text;
}

}  // namespace
}  // namespace springgrasp
