#include "kinematics/fast_hand.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "real_models.h"

namespace springgrasp {
namespace {

void ExpectAsByForwardKinematics(const RobotHand& robot, const FastHand& hand,
                                 const ValveAngles& x) {
  Eigen::VectorXd q(robot.tree.num_joints());
  for (int j = 0; j < q.size(); ++j) q[j] = x[robot.valve_of[j]];
  std::vector<Pose> X_HB;
  ForwardKinematics(robot.tree, q, X_HB);
  for (std::size_t b = 0; b < X_HB.size(); ++b) {
    const FastHand::Body& body = hand.body(static_cast<int>(b));
    EXPECT_LT((body.R_HB - X_HB[b].linear()).norm(), 1e-13) << "body " << b;
    EXPECT_LT((body.p_HB - X_HB[b].translation()).norm(), 1e-14) << "body " << b;
  }
}

// Valves are moved all at once, one at a time, and back: what has not moved is not computed again.
TEST(FastHandTest, StandsWhereForwardKinematicsSays) {
  for (const RobotHand* robot : {&TestRobotHand(), &TestOppositionHand()}) {
    RandomEngine engine = MakeStream(1, 0, "fast hand");
    FastHand hand(*robot);
    ValveAngles x = ValveAngles::Zero();
    const ValveAngles first = x;
    hand.Move(x);
    ExpectAsByForwardKinematics(*robot, hand, x);
    for (std::size_t v = 0; v < robot->valves.size(); ++v) {
      x[static_cast<int>(v)] = Uniform(engine, -1.5, 1.5);
      hand.Move(x);
      ExpectAsByForwardKinematics(*robot, hand, x);
      hand.Move(x);
      ExpectAsByForwardKinematics(*robot, hand, x);
    }
    hand.Move(first);
    ExpectAsByForwardKinematics(*robot, hand, first);
  }
}

TEST(FastHandTest, AHandWithSlidesIsAnError) {
  RobotHand robot = TestRobotHand();
  for (KinematicTree::Node& node : robot.tree.nodes) node.slide = node.joint >= 0;
  EXPECT_THROW(FastHand hand(robot), Error);
}

}  // namespace
}  // namespace springgrasp
