#include "kinematics/reach_path.h"

#include <gtest/gtest.h>

#include "motion/minimum_jerk.h"
#include "test_arm.h"

namespace springgrasp {
namespace {

constexpr int kSamples = 300;

// From 12 cm in front of where the arm stands at home back to there, and a rest.
ReachPathRequest MakeWay() {
  const Arm& arm = TestArm();
  ReachPathRequest request;
  request.q_goal = HomePosture(arm);
  const Pose X_WH_goal = HandPose(arm, request.q_goal);
  for (int k = 0; k < kSamples; ++k) {
    Pose X = X_WH_goal;
    X.translation().y() += 0.12 * (1 - MinimumJerkPosition(k / 250.0));
    request.X_WH.push_back(X);
  }
  return request;
}

void ExpectSteps(const ReachPath& path, const ReachPathRequest& request) {
  ASSERT_TRUE(path.complete) << path.reason;
  ASSERT_EQ(path.q.size(), request.X_WH.size());
  ASSERT_EQ(path.X_WH.size(), request.X_WH.size());
  for (std::size_t k = 0; k < path.q.size(); ++k) {
    const Pose X = HandPose(TestArm(), path.q[k]);
    EXPECT_LT((X.translation() - path.X_WH[k].translation()).norm(), 2e-4);
    if (k > 0) {
      EXPECT_LE((path.q[k] - path.q[k - 1]).cwiseAbs().maxCoeff(), request.max_speed * request.dt);
    }
  }
  for (int k = path.join; k < kSamples; ++k) {
    EXPECT_LT((path.X_WH[k].translation() - request.X_WH[k].translation()).norm(), 1e-9);
  }
}

TEST(ReachPathTest, AWayThatTheArmCanFollowIsFollowedWhole) {
  const ReachPathRequest request = MakeWay();
  const ReachPath path = FollowReach(TestArm(), request);
  ExpectSteps(path, request);
  EXPECT_EQ(path.join, 0);
}

TEST(ReachPathTest, AWayThatBeginsOutOfReachIsJoinedFromTheStart) {
  ReachPathRequest request = MakeWay();
  for (int k = 0; k < 60; ++k) request.X_WH[k].translation().x() += 3;
  EXPECT_FALSE(FollowReach(TestArm(), request).complete);
  request.q_start = request.q_goal;
  (*request.q_start)[3] += 0.2;
  request.latest_join = 150;
  const ReachPath path = FollowReach(TestArm(), request);
  ExpectSteps(path, request);
  EXPECT_GT(path.join, 60);
  EXPECT_LE(path.join, 150);
  EXPECT_LT((path.q.front() - *request.q_start).norm(), 1e-9);
  // It joins without a jump of speed or acceleration.
  const auto bend = [&](int k) -> Eigen::VectorXd {
    return path.q[k + 1] - 2 * path.q[k] + path.q[k - 1];
  };
  for (int k = 2; k < path.join + 10; ++k) {
    EXPECT_LT((bend(k) - bend(k - 1)).cwiseAbs().maxCoeff(), 0.02 * request.max_speed * request.dt)
        << k;
  }
}

TEST(ReachPathTest, NothingIsJoinedThroughAnObstacle) {
  ReachPathRequest request = MakeWay();
  for (int k = 0; k < 60; ++k) request.X_WH[k].translation().x() += 3;
  request.q_start = request.q_goal;
  request.latest_join = 150;
  int asked = 0;
  request.clear = [&](const std::vector<Pose>&, const std::vector<Eigen::VectorXd>&, int) {
    ++asked;
    return false;
  };
  const ReachPath path = FollowReach(TestArm(), request);
  EXPECT_FALSE(path.complete);
  EXPECT_FALSE(path.reason.empty());
  EXPECT_GT(asked, 0);
}

}  // namespace
}  // namespace springgrasp
