#include "grasp/learn_reach.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr double kDt = 0.01;

// A reach of 0.25 m in 1 s, whose end is still turned by 0.05 rad in its last tenth of a second:
// the tracked hand's pose is least certain where the object hides it.
std::vector<Pose> ReachThatTurnsAtItsEnd() {
  std::vector<Pose> X_OG;
  for (int i = 0; i <= 100; ++i) {
    const double s = MinimumJerkPosition(kDt * i);
    const double late = std::max(0.0, kDt * i - 0.9) / 0.1;
    X_OG.push_back(MakePose(Eigen::Vector3d(-0.25, 0.05, 0.1) * (1 - s),
                            ExpRotation(Eigen::Vector3d(0.3 * (1 - s), 0, 0.05 * late * late))));
  }
  return X_OG;
}

TEST(LearnReachTest, TheHandRestsAtItsGoalAfterT) {
  const std::vector<Pose> X_OG = ReachThatTurnsAtItsEnd();
  const LearnedReach reach = LearnReach(X_OG, kDt, 20);
  EXPECT_LT(reach.rmse, 0.002);
  // No farther off than the turn that disturbed it.
  const Pose X_goal = GoalPose(reach.dmp);
  for (const Pose& X :
       RolloutPoseDmp(reach.dmp, Eigen::VectorXd::LinSpaced(6, 1.0, 1.5) * reach.T).X_WB) {
    EXPECT_LT((X.translation() - X_goal.translation()).norm(), 0.003);
    EXPECT_LT(RotationDistance(Eigen::Quaterniond(X.linear()), Eigen::Quaterniond(X_goal.linear())),
              0.05);
  }
}

}  // namespace
}  // namespace springgrasp
