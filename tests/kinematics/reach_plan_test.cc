#include "kinematics/reach_plan.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>

#include "kinematics/shape_distance.h"
#include "posture_requests.h"
#include "test_arm.h"

namespace springgrasp {
namespace {

// A grasp of an object that stands on a table, reached from the arm's home posture in 1.5 s.
ReachRequest MakeReach(const std::string& type, const std::string& shape,
                       const Eigen::Vector3d& wrist_O, const Eigen::Vector2d& place, double table) {
  const ContactPosture posture =
      SolveContactPosture(TestRobotHand(), MakeRequest(type, ParseShape(shape), wrist_O));
  ReachRequest request;
  request.shape = ParseShape(shape);
  request.X_WO.translation() << place,
      table + 0.5 * request.shape.size.z() + (type == "pinch" ? 0.02 : 0);
  request.X_HO = posture.X_HO;
  request.X_HC = ContactFrame(request.shape, posture);
  request.tilt_free = type != "power";
  request.table_height = table;
  request.table_edge = 0.41;
  request.T = 1.5;
  request.q_hand.assign(450, posture.q);
  request.q_start = HomePosture(TestArm());
  const Pose X_WH_start = HandPose(TestArm(), *request.q_start);
  const Pose X_WO = request.X_WO, X_HO = request.X_HO;
  request.path = [=](const Pose& X_OF) {
    const Pose X_WH_goal = X_WO * X_OF * X_HO.inverse();
    const Eigen::Vector3d turn =
        LogRotation(Eigen::Quaterniond(X_WH_start.linear().transpose() * X_WH_goal.linear()));
    std::vector<Pose> path;
    for (int k = 0; k < 450; ++k) {
      const double u = std::min(1.0, k / 300.0), s = u * u * u * (10 + u * (6 * u - 15));
      path.push_back(MakePose(
          X_WH_start.translation() + s * (X_WH_goal.translation() - X_WH_start.translation()),
          Eigen::Quaterniond(X_WH_start.linear()) * ExpRotation(s * turn)));
    }
    return path;
  };
  request.clear = [](const std::vector<Pose>&) { return true; };
  return request;
}

void ExpectSound(const ReachRequest& request, const ReachPlan& plan) {
  ASSERT_TRUE(plan.reachable) << plan.reason;
  const Arm& arm = TestArm();
  ASSERT_EQ(plan.arm.size(), plan.X_WH.size());
  EXPECT_LT((plan.arm.front() - *request.q_start).norm(), 0.01) << "begins where the arm stands";
  for (std::size_t k = 0; k < plan.arm.size(); ++k) {
    const Pose X = HandPose(arm, plan.arm[k]);
    EXPECT_LT((X.translation() - plan.X_WH[k].translation()).norm(), 2e-4);
    const Eigen::VectorXd step = plan.arm[k] - plan.arm[k > 0 ? k - 1 : 0];
    EXPECT_LT(step.cwiseAbs().maxCoeff(), 4 * 0.005 + 1e-9);
  }
  // The object is where it was believed to be, up to what the shape leaves free.
  const Pose X_WO = plan.X_WH.back() * request.X_HO;
  EXPECT_LT((X_WO.matrix() - (request.X_WO * plan.X_OF).matrix()).norm(), 1e-3);
  const double lifted =
      HandPose(arm, plan.lift.back()).translation().z() - plan.X_WH.back().translation().z();
  EXPECT_NEAR(lifted, 0.15, 1e-3);
  for (int axis = 0; axis < 3; ++axis) {
    double most = 0;
    for (const Eigen::VectorXd& q : plan.shake[axis]) {
      most = std::max(most, std::abs((HandPose(arm, q).translation() -
                                      HandPose(arm, plan.lift.back()).translation())[axis]));
    }
    EXPECT_NEAR(most, 0.02, 0.002);
    EXPECT_LT((plan.shake[axis].back() - plan.lift.back()).norm(), 1e-3);
  }
  EXPECT_GT(plan.limit_margin, 0);
}

TEST(ReachPlanTest, SideGraspsOfCylindersInTheReachWindow) {
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(0.35, 0.5), Eigen::Vector2d(0.4, 0.45)}) {
    const ReachRequest request = MakeReach("power", "cylinder:0.05x0.18", {0, -1, 0}, place, 0.95);
    const ReachPlan plan = PlanReach(TestArm(), TestRobotHand(), request);
    ExpectSound(request, plan);
    EXPECT_GT(plan.table_clearance, 0.005);
  }
}

TEST(ReachPlanTest, PinchesOfABallInTheReachWindow) {
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(0.35, 0.45), Eigen::Vector2d(0.42, 0.42)}) {
    const ReachRequest request = MakeReach("pinch", "sphere:0.04", {0, -0.6, 0.8}, place, 0.85);
    ExpectSound(request, PlanReach(TestArm(), TestRobotHand(), request));
  }
}

TEST(ReachPlanTest, AnObjectOutOfReachIsAValueWithAReason) {
  const ReachRequest request =
      MakeReach("power", "cylinder:0.05x0.18", {0, -1, 0}, {0.3, 1.2}, 0.95);
  const ReachPlan plan = PlanReach(TestArm(), TestRobotHand(), request);
  EXPECT_FALSE(plan.reachable);
  EXPECT_THAT(plan.reason, ::testing::HasSubstr("no arm posture"));
}

TEST(FreeMotionsTest, KeepTheContactsOnTheObject) {
  for (const char* text : {"sphere:0.04", "cylinder:0.05x0.1", "box:0.04x0.04x0.06"}) {
    const ContactRequest contact = MakeRequest("pinch", ParseShape(text), {0, -1, 0});
    const ContactPosture posture = SolveContactPosture(TestRobotHand(), contact);
    ReachRequest request;
    request.shape = contact.shape;
    request.X_HO = posture.X_HO;
    request.X_HC = ContactFrame(request.shape, posture);
    const std::vector<FreeMotion> motions = FreeMotions(request);
    EXPECT_TRUE(motions.front().X_OF.isApprox(Pose::Identity()));
    for (const FreeMotion& motion : motions) {
      for (const int f : {kThumb, kIndex}) {
        const double gap = SignedDistance(contact.shape, motion.X_OF * posture.p_OC[f]) -
                           TestRobotHand().tip_radius;
        EXPECT_LT(std::abs(gap), 0.001) << text;
      }
    }
  }
}

TEST(FreeMotionsTest, TiltsAndSlidesKeepPadsOnTheFacesOfACard) {
  const ContactRequest contact = MakeTurnedPinch(ParseShape("box:0.005x0.06x0.08"), 0.6);
  const ContactPosture posture = SolveContactPosture(TestRobotHand(), contact);
  ReachRequest request;
  request.shape = contact.shape;
  request.X_HO = posture.X_HO;
  request.X_HC = ContactFrame(contact.shape, posture);
  ReachOptions options;
  options.max_tilt = options.any_tilt;
  options.slide_step = 0.01;
  double highest = 0;
  for (const FreeMotion& motion : FreeMotions(request, options)) {
    for (const int f : {kThumb, kIndex}) {
      const Eigen::Vector3d p = motion.X_OF * posture.p_OC[f];
      EXPECT_NEAR(std::abs(p.x()), 0.0025 + TestRobotHand().tip_radius, 0.001)
          << "tilt " << motion.tilt << " slide " << motion.slide;
      EXPECT_LT(p.z(), 0.04 - 0.01);
      highest = std::max(highest, p.z());
    }
  }
  EXPECT_GT(highest, 0.015) << "the contacts slide up";
}

TEST(ReachPlanTest, WhatIsRefusedIsNotTaken) {
  ReachRequest request = MakeReach("pinch", "sphere:0.04", {0, -0.6, 0.8}, {0.35, 0.45}, 0.85);
  int asked = 0;
  request.refusal = [&](const ReachPlan& plan) {
    EXPECT_FALSE(plan.lift.empty());
    return asked++ == 0 ? "not this one" : "";
  };
  ExpectSound(request, PlanReach(TestArm(), TestRobotHand(), request));
  EXPECT_EQ(asked, 2);
  request.refusal = [](const ReachPlan&) { return "none of them"; };
  const ReachPlan none = PlanReach(TestArm(), TestRobotHand(), request);
  EXPECT_FALSE(none.reachable);
  EXPECT_EQ(none.reason, "none of them");
}

TEST(ReachPlanTest, HandsTurnFarOrSlideOnlyWhereTheyMayAndMust) {
  ReachRequest request =
      MakeReach("pinch", "box:0.03x0.03x0.12", {0, -0.6, 0.8}, {0.35, 0.45}, 0.85);
  const auto far = [](const ReachPlan& plan) {
    return plan.slide > 0 || std::abs(plan.tilt) > ReachOptions().max_tilt + 1e-9;
  };
  const ReachPlan near = PlanReach(TestArm(), TestRobotHand(), request);
  ASSERT_TRUE(near.reachable) << near.reason;
  EXPECT_FALSE(far(near));
  request.refusal = [&](const ReachPlan& plan) { return far(plan) ? "" : "blocked"; };
  const ReachPlan farther = PlanReach(TestArm(), TestRobotHand(), request);
  ASSERT_TRUE(farther.reachable) << farther.reason;
  EXPECT_TRUE(far(farther));
  request.tilt_far = false;
  EXPECT_FALSE(PlanReach(TestArm(), TestRobotHand(), request).reachable);
}

TEST(ReachPlanTest, KeepsTheAskedDistanceFromTheTable) {
  const ReachRequest request =
      MakeReach("pinch", "sphere:0.04", {0, -0.6, 0.8}, {0.35, 0.45}, 0.85);
  const auto above = [&](const Pose& X_WH) {
    return HandAboveTable(TestRobotHand(), X_WH, request.q_hand.back(), request.table_height,
                          request.table_edge);
  };
  ReachOptions options;
  options.least_clearance = 0.015;
  const ReachPlan plan = PlanReach(TestArm(), TestRobotHand(), request, options);
  ASSERT_TRUE(plan.reachable) << plan.reason;
  EXPECT_GE(above(plan.X_WH.back()), 0.015);
  ASSERT_FALSE(plan.holds.empty());
  for (const Pose& X_WH : plan.holds) EXPECT_GE(above(X_WH), 0.015);
}

// A knob beside the ball, where the little finger of a hand that is planned without it would be.
TEST(ReachPlanTest, KeepsTheHandOffWhatStandsBesideTheObject) {
  ReachRequest request = MakeReach("pinch", "sphere:0.04", {0, -0.6, 0.8}, {0.35, 0.45}, 0.85);
  const ReachPlan free = PlanReach(TestArm(), TestRobotHand(), request);
  ASSERT_TRUE(free.reachable) << free.reason;
  Obstacle knob{ParseShape("sphere:0.02"), Pose::Identity()};
  std::vector<Pose> X_HB;
  ForwardKinematics(TestRobotHand().tree, request.q_hand.back(), X_HB);
  const LinkCapsule& link = *std::ranges::find(TestRobotHand().capsules, 4, &LinkCapsule::finger);
  knob.X_WS.translation() = free.X_WH.back() * (X_HB[link.node] * link.a);
  request.obstacles.push_back(knob);
  const auto distance = [&](const Pose& X_WH) {
    return HandDistance(TestRobotHand(), X_HB, knob.X_WS.inverse() * X_WH, knob.shape,
                        {true, true, true, true, true}, true);
  };
  EXPECT_LT(distance(free.X_WH.back()), 0);
  const ReachPlan around = PlanReach(TestArm(), TestRobotHand(), request);
  ExpectSound(request, around);
  for (const Pose& X_WH : around.X_WH) EXPECT_GT(distance(X_WH), 0);
}

TEST(RaisePathTest, LiftsTheMiddleAndKeepsTheEnds) {
  const RobotHand& hand = TestRobotHand();
  const std::vector<Eigen::VectorXd> q(101, hand.open);
  std::vector<Pose> path(101, HandPose(TestArm(), HomePosture(TestArm())));
  for (int k = 0; k <= 100; ++k) path[k].translation().y() += 0.002 * k;
  const std::vector<Pose> before = path;
  const double lowest = HandAboveTable(hand, path[50], q[50], 0, -1e9);
  const double raise = RaisePath(hand, q, lowest + 0.02, -1e9, 0.01, 100, path);
  EXPECT_GT(raise, 0.029);
  EXPECT_LT((path.front().matrix() - before.front().matrix()).norm(), 1e-12);
  EXPECT_LT((path.back().matrix() - before.back().matrix()).norm(), 1e-12);
  EXPECT_GE(HandAboveTable(hand, path[50], q[50], lowest + 0.02, -1e9), 0.0099);
}

}  // namespace
}  // namespace springgrasp
