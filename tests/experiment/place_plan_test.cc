#include "experiment/place_plan.h"

#include <gtest/gtest.h>

#include "../kinematics/test_arm.h"

namespace springgrasp {
namespace {

// The hand came 10 cm forwards to an object, lifted it, and shall set it down `aside` of there.
PlaceRequest Carrying(const Eigen::Vector3d& aside) {
  const Arm& arm = TestArm();
  PlaceRequest request;
  const Pose X_WH = HandPose(arm, HomePosture(arm));
  for (int k = 0; k <= 300; ++k) {
    request.X_WH.push_back(X_WH);
    request.X_WH.back().translation().y() -= 0.10 * (1 - k / 200.0) * (k < 200 ? 1 : 0);
  }
  request.X_WO.translation() = X_WH.translation() + Eigen::Vector3d(0, 0.1, 0);
  request.X_WO_place.translation() = request.X_WO.translation() + aside;
  request.lift = 0.08;
  Pose X_WH_lifted = X_WH;
  X_WH_lifted.translation().z() += request.lift;
  request.q_lifted = SolveArmIk(arm, X_WH_lifted, HomePosture(arm)).value();
  return request;
}

double Distance(const Pose& a, const Eigen::Vector3d& p) { return (a.translation() - p).norm(); }

TEST(PlacePlanTest, CarriesTheObjectFromWhereItWasLiftedToItsPlace) {
  const Eigen::Vector3d aside(-0.06, 0.02, 0.01);
  const PlaceRequest request = Carrying(aside);
  const PlacePlan plan = PlanPlace(TestArm(), request);
  ASSERT_TRUE(plan.complete) << plan.reason;
  const Eigen::Vector3d p_WH_grasp = request.X_WH.back().translation();
  EXPECT_LT(Distance(plan.X_WH.front(), p_WH_grasp + Eigen::Vector3d(0, 0, request.lift)), 1e-6);
  EXPECT_LT(Distance(plan.X_WH.back(), p_WH_grasp + aside), 1e-3);
  ASSERT_EQ(plan.arm.size(), plan.X_WH.size());
  for (std::size_t k = 0; k < plan.arm.size(); ++k) {
    EXPECT_LT(Distance(HandPose(TestArm(), plan.arm[k]), plan.X_WH[k].translation()), 2e-4);
  }
}

TEST(PlacePlanTest, IsAboveThePlaceBeforeItIsLow) {
  const Eigen::Vector3d aside(-0.06, 0, 0);
  const PlaceRequest request = Carrying(aside);
  const PlacePlan plan = PlanPlace(TestArm(), request);
  ASSERT_TRUE(plan.complete) << plan.reason;
  const Eigen::Vector3d p_WH_place = request.X_WH.back().translation() + aside;
  for (const Pose& X : plan.X_WH) {
    const Eigen::Vector3d off = X.translation() - p_WH_place;
    EXPECT_TRUE(off.z() > 0.25 * request.lift || off.head<2>().norm() < 0.01);
  }
}

TEST(PlacePlanTest, LeavesTheObjectTheWayTheHandCame) {
  const Eigen::Vector3d aside(-0.06, 0, 0);
  const PlaceRequest request = Carrying(aside);
  const PlacePlan plan = PlanPlace(TestArm(), request);
  ASSERT_TRUE(plan.complete) << plan.reason;
  const Pose first = HandPose(TestArm(), plan.retreat.front());
  const Pose last = HandPose(TestArm(), plan.retreat.back());
  EXPECT_LT(Distance(first, plan.X_WH.back().translation()), 1e-3);
  EXPECT_LT(last.translation().y(), first.translation().y() - 0.03);
  EXPECT_NEAR(last.translation().x(), first.translation().x(), 1e-3);
  EXPECT_NEAR(last.translation().z(), first.translation().z(), 1e-3);
}

TEST(PlacePlanTest, SaysThatAPlaceIsOutOfReach) {
  const PlacePlan plan = PlanPlace(TestArm(), Carrying({0, 3, 0}));
  EXPECT_FALSE(plan.complete);
  EXPECT_EQ(plan.reason.find("placing: "), 0U) << plan.reason;
}

}  // namespace
}  // namespace springgrasp
