#include "kinematics/mirror.h"

#include <gtest/gtest.h>

#include "kinematics/robot_hand.h"
#include "sim/kinematic_tree_of.h"
#include "sim/mujoco_handles.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

class MirrorTest : public ::testing::Test {
 protected:
  const ModelPtr model_ = LoadModelFile(ModelPath("armar3b/armar3b.xml"));
};

TEST_F(MirrorTest, TheImageOfTheLeftHandIsTheRightHand) {
  const RobotHand right = MakeArmarHand(KinematicTreeOf(*model_, "hand_r"), "hand_r");
  const RobotHand image =
      MakeArmarHand(MirroredTree(KinematicTreeOf(*model_, "hand_l"), false), "hand_r");
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(right.tree.num_joints(), 0.1, 1.2);
  const auto a = TipPositions(right, q), b = TipPositions(image, q);
  for (int f = 0; f < kNumFingers; ++f) EXPECT_LT((a[f] - b[f]).norm(), 1e-6) << f;
}

TEST_F(MirrorTest, PosesOfTheImageAreThoseOfTheLeftArmMirrored) {
  const KinematicTree left = KinematicTreeOf(*model_, "world", {"hand_l_H"});
  const KinematicTree image = MirroredTree(left, true);
  const Eigen::VectorXd q = Eigen::VectorXd::LinSpaced(left.num_joints(), -0.4, 0.5);
  std::vector<Pose> X_left, X_image;
  ForwardKinematics(left, q, X_left);
  ForwardKinematics(image, q, X_image);
  const Pose X = FramePose(left, X_left, left.FrameIndex("hand_l_H"));
  const Pose mirrored = FramePose(image, X_image, image.FrameIndex("hand_r_H"));
  EXPECT_TRUE(MirroredBodyPose(X).isApprox(mirrored, 1e-9));
  EXPECT_NEAR(mirrored.linear().determinant(), 1, 1e-9);
  EXPECT_TRUE(MirroredBodyPose(mirrored).isApprox(X, 1e-9));
}

}  // namespace
}  // namespace springgrasp
