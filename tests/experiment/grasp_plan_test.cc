#include "experiment/grasp_plan.h"

#include <gtest/gtest.h>

#include <numbers>

namespace springgrasp {
namespace {

// Half a metre along x in 10 ms, turning a right angle about z.
GraspPlan TwoSamples() {
  GraspPlan plan;
  plan.dt = 0.01;
  plan.X_WH = {Pose::Identity(),
               MakePose({0.5, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(
                                         std::numbers::pi / 2, Eigen::Vector3d::UnitZ())))};
  PerFinger<Eigen::Vector3d> tips;
  tips.fill({0.5, 0.1, 0});
  plan.p_WF = {tips, tips};
  return plan;
}

TEST(GraspPlanTest, HandPoseLiesBetweenItsSamples) {
  const Pose X = PlannedHandPose(TwoSamples(), 0.005);
  EXPECT_NEAR(X.translation().x(), 0.25, 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(X.linear()).angle(), std::numbers::pi / 4, 1e-12);
}

TEST(GraspPlanTest, HandPoseStaysAtTheEnds) {
  const GraspPlan plan = TwoSamples();
  EXPECT_TRUE(PlannedHandPose(plan, -1).isApprox(plan.X_WH.front()));
  EXPECT_TRUE(PlannedHandPose(plan, 1).isApprox(plan.X_WH.back()));
}

TEST(GraspPlanTest, TipsAreSeenFromTheHandOfTheirSample) {
  const GraspPlan plan = TwoSamples();
  EXPECT_TRUE(PlannedTipInHand(plan, 0, kThumb).isApprox(Eigen::Vector3d(0.5, 0.1, 0)));
  EXPECT_TRUE(PlannedTipInHand(plan, 1, kThumb).isApprox(Eigen::Vector3d(0.1, 0, 0)));
}

}  // namespace
}  // namespace springgrasp
