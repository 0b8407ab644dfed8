#include "kinematics/arm_ik.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "test_arm.h"

namespace springgrasp {
namespace {

Eigen::VectorXd RandomArmPosture(const Arm& arm, RandomEngine& engine) {
  Eigen::VectorXd q(arm.num_joints());
  for (int i = 0; i < arm.num_joints(); ++i) {
    q[i] =
        Uniform(engine, arm.tree.lower[arm.joints[i]] + 0.03, arm.tree.upper[arm.joints[i]] - 0.03);
  }
  return q;
}

TEST(ArmIkTest, ReachesPosesThatSomePostureHas) {
  const Arm& arm = TestArm();
  EXPECT_EQ(arm.num_joints(), 7);
  RandomEngine engine = MakeStream(1, 0, "arm");
  int solved = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Pose X_WH = HandPose(arm, RandomArmPosture(arm, engine));
    const auto q = SolveArmIkFromAnywhere(arm, X_WH);
    if (!q) continue;
    ++solved;
    const Pose X = HandPose(arm, *q);
    EXPECT_LT((X.translation() - X_WH.translation()).norm(), 1e-4);
    EXPECT_LT(RotationDistance(Eigen::Quaterniond(X.linear()), Eigen::Quaterniond(X_WH.linear())),
              1e-3);
    EXPECT_GE(LimitMargin(arm, *q), 0);
  }
  EXPECT_GE(solved, 149);
}

TEST(ArmIkTest, FarPosesAreUnreachableAsAValue) {
  EXPECT_FALSE(SolveArmIkFromAnywhere(TestArm(), MakePose({2, 2, 2}, ExpRotation({0, 0, 0}))));
}

TEST(ArmIkTest, FollowsAPathWithoutJumps) {
  const Arm& arm = TestArm();
  const Eigen::VectorXd home = HomePosture(arm);
  const Pose X_start = HandPose(arm, home);
  std::vector<Pose> path;
  for (int k = 0; k <= 200; ++k) {
    const double s = k / 200.0, u = s * s * (3 - 2 * s);
    Pose X = X_start;
    X.translation() += u * Eigen::Vector3d(0.1, 0.06, 0.05);
    X.linear() = X_start.linear() * ExpRotation(u * Eigen::Vector3d(0.2, 0.1, -0.1));
    path.push_back(X);
  }
  const ArmPath found = TrackArmPath(arm, path, home);
  ASSERT_TRUE(found.complete) << found.reason;
  ASSERT_EQ(found.q.size(), path.size());
  EXPECT_LT(found.max_step, 0.03);
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Pose X = HandPose(arm, found.q[k]);
    EXPECT_LT((X.translation() - path[k].translation()).norm(), 1e-4);
  }
}

TEST(ArmIkTest, APathOutOfReachSaysWhereItEnds) {
  const Arm& arm = TestArm();
  std::vector<Pose> path;
  for (int k = 0; k <= 100; ++k) {
    Pose X = HandPose(arm, HomePosture(arm));
    X.translation().y() += 0.01 * k;
    path.push_back(X);
  }
  const ArmPath found = TrackArmPath(arm, path, HomePosture(arm));
  EXPECT_FALSE(found.complete);
  EXPECT_GT(found.q.size(), 5u);
  EXPECT_LT(found.q.size(), 60u);
  EXPECT_THAT(found.reason, ::testing::HasSubstr("sample"));
}

TEST(ArmIkTest, TheTorsoCanHelp) {
  const auto model = LoadModel("armar3b/armar3b.xml");
  const KinematicTree tree = KinematicTreeOf(*model, "world", {"hand_r_H"});
  const Arm arm =
      MakeArm(tree, "hand_r_H", "arm_r_", Eigen::VectorXd::Zero(tree.num_joints()), true);
  EXPECT_EQ(arm.num_joints(), 10);
  EXPECT_THROW(MakeArm(tree, "hand_r_H", "leg_", Eigen::VectorXd::Zero(tree.num_joints())), Error);
}

}  // namespace
}  // namespace springgrasp
