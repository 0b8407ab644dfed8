#include "experiment/reach_report.h"

#include <gmock/gmock.h>

namespace springgrasp {
namespace {

using ::testing::HasSubstr;

Scene WithBallAt(double x, double y) {
  return ParseScene(
      "table: {height: 0.85, size: [0.7, 0.5, 0.03], position: [0.3, 0.66]}\n"
      "objects:\n"
      "  - {name: ball, shape: \"sphere:0.04\", pose: [" +
          std::to_string(x) + ", " + std::to_string(y) + ", 0.95]}\n",
      "test");
}

ReachMapOptions Coarse() {
  ReachMapOptions options;
  options.cell = 0.4;
  return options;
}

TEST(ReachReportTest, SaysWhatIsWithinReach) {
  const Scene scene = WithBallAt(0.4, 0.5);
  const ReachReport report = ReportReach(scene, {}, Coarse());
  ASSERT_EQ(report.maps.size(), 3u);
  ASSERT_EQ(report.objects.size(), 1u);
  EXPECT_GT(report.objects[0].above, 0);
  EXPECT_TRUE(report.objects[0].moves.empty());
  EXPECT_THAT(FormatReachReport(report), HasSubstr("ball at (0.40, 0.50, 0.95): within reach"));
  EXPECT_FALSE(DrawReachReport(report, scene).empty());
}

TEST(ReachReportTest, ThePlatformBringsAnObjectIntoReach) {
  const Scene scene = WithBallAt(0.9, 0.45);
  const Eigen::Vector3d ball(0.9, 0.45, 0.95);
  const std::vector<BasePosture> moves = MovesIntoReach(scene, {false, true}, ball, {});
  ASSERT_FALSE(moves.empty());
  EXPECT_GT(moves.front().at("platform_x"), 0);
  EXPECT_TRUE(MovesIntoReach(scene, {false, false}, ball, {}).empty());
}

TEST(ReachReportTest, ThePlatformMovesToWhereAGraspHolds) {
  // A hand from above, fingers down, far to the right.
  Pose X_WH = Pose::Identity();
  X_WH.linear().col(0) = -Eigen::Vector3d::UnitZ();
  X_WH.linear().col(1) = Eigen::Vector3d::UnitX();
  X_WH.linear().col(2) = -Eigen::Vector3d::UnitY();
  std::vector<Pose> holds;
  for (const double yaw : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
    Pose turned = X_WH;
    turned.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * X_WH.linear();
    turned.translation() = Eigen::Vector3d(0.9, 0.45, 1.1);
    holds.push_back(turned);
  }
  const Scene scene = WithBallAt(0.9, 0.45);
  const std::vector<BasePosture> moves = MovesToHold(scene, {false, true}, holds, 0.1, 5);
  ASSERT_FALSE(moves.empty());
  for (const BasePosture& base : moves) EXPECT_GT(base.at("platform_x"), 0);
  EXPECT_TRUE(MovesToHold(scene, {false, true}, {}, 0.1, 5).empty());
  EXPECT_TRUE(MovesToHold(scene, {false, false}, holds, 0.1, 5).empty());
}

TEST(ReachReportTest, ATurnedHipIsInTheTableWhereAStraightOneIsNot) {
  Scene scene = WithBallAt(0.3, 0.5);
  scene.table.height = 0.93;
  scene.active = {"right_arm", "right_hand", "torso", "platform"};
  EXPECT_TRUE(StandsClear(scene, {}));
  EXPECT_TRUE(StandsClear(scene, {{"platform_x", 0.2}, {"platform_y", 0.1}}));
  EXPECT_FALSE(StandsClear(scene, {{"platform_x", 0.2}, {"platform_y", 0.1}, {"torso_yaw", 0.52}}));
}

TEST(ReachReportTest, AidsAreWhatTheSceneLetsMove) {
  Scene scene = WithBallAt(0.4, 0.5);
  EXPECT_FALSE(AidsOf(scene).torso);
  scene.torso = "free";
  scene.active.push_back("platform");
  EXPECT_TRUE(AidsOf(scene).torso);
  EXPECT_TRUE(AidsOf(scene).platform);
}

}  // namespace
}  // namespace springgrasp
