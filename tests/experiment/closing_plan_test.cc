#include "experiment/closing_plan.h"

#include <gtest/gtest.h>

#include <cmath>

#include "kinematics/power_posture.h"
#include "sim/kinematic_tree_of.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

constexpr double kDt = 0.005, kT = 1;
constexpr int kAtArrival = 200;

RobotHand Hand() {
  const ModelPtr model = LoadModelFile(ModelPath("armar3b/armar3b.xml"));
  return MakeArmarHand(KinematicTreeOf(*model, "hand_r"), "hand_r");
}

// A hand that a human-like motion has half closed long before it arrives.
std::vector<Eigen::VectorXd> Plan(const RobotHand& hand, const Eigen::VectorXd& q_contact) {
  HandMotionResult motion;
  for (int k = 0; k <= 300; ++k) {
    const double closed = std::min(1.0, k / 200.0);
    motion.q.push_back(hand.open + closed * (q_contact - hand.open));
    motion.p_HF.push_back(TipPositions(hand, motion.q.back()));
  }
  return CloseAfterArrival(hand, motion, {true, true, true, true, true}, hand.open, q_contact, kDt,
                           kT);
}

TEST(ClosingPlanTest, WaitsOpenUntilTheArmIsThereAndEndsOnTheContacts) {
  const RobotHand hand = Hand();
  Eigen::VectorXd q_contact = Eigen::VectorXd::Constant(11, 0.6);
  q_contact[hand.palm] = 0.1;
  const auto q = Plan(hand, q_contact);
  EXPECT_LT((q[kAtArrival] - hand.open).tail(10).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(q[kAtArrival][hand.palm], 0.1, 1e-9);
  EXPECT_LT((q.back() - q_contact).norm(), 1e-9);
}

TEST(ClosingPlanTest, JointsOnOneValveTurnAlikeAndAfterTheOthers) {
  const RobotHand hand = Hand();
  Eigen::VectorXd q_contact = Eigen::VectorXd::Constant(11, 0.6);
  q_contact[hand.palm] = 0;
  for (const int f : {kRing, kPinkie}) {
    ASSERT_TRUE(OnOneValve(hand, f));
    q_contact[hand.fingers[f].j0] = 0.2;
    q_contact[hand.fingers[f].j1] = 1.2;
  }
  ASSERT_FALSE(OnOneValve(hand, kIndex));
  const auto q = Plan(hand, q_contact);
  const RobotHand::Finger& ring = hand.fingers[kRing];
  for (int k = kAtArrival; k <= 300; ++k) {
    const double proximal = q[k][ring.j0], distal = q[k][ring.j1];
    EXPECT_LE(proximal, 0.2 + 1e-9);
    if (proximal < 0.2 - 1e-9) {
      EXPECT_NEAR(proximal, distal, 1e-9);
      continue;
    }
    // The others hold the object by the time that the first phalanx would push it.
    EXPECT_NEAR(q[k][hand.fingers[kIndex].j1], 0.6, 1e-6);
  }
  EXPECT_NEAR(q.back()[ring.j1], 1.2, 1e-9);
}

}  // namespace
}  // namespace springgrasp
