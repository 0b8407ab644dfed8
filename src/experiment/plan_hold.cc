#include "experiment/plan_hold.h"

#include "control/hanging_hand.h"
#include "experiment/grasp_requests.h"
#include "kinematics/shape_distance.h"
#include "kinematics/smooth_hand_ik.h"

namespace springgrasp {
namespace {

// In a hand's frame H, m/s^2.
Eigen::Vector3d GravityIn(const Pose& X_WH) {
  return X_WH.linear().transpose() * Eigen::Vector3d(0, 0, -9.81);
}

PneumaticHandModel DrivesOf(const RobotHand& hand) {
  return PneumaticHandModel(hand.opposition >= 0 ? OppositionHand() : DocumentedHand());
}

// The contact posture with the joints where the hand that holds the object at X_WO can have them.
ContactPosture SolveHangingPosture(const RobotHand& hand, const ContactRequest& contacts,
                                   const Pose& X_WO) {
  constexpr int kRounds = 3;
  constexpr double kClose = 0.01;  // rad
  const PneumaticHandModel drives = DrivesOf(hand);
  ContactPosture posture = SolveContactPosture(hand, contacts);
  for (int round = 0; round < kRounds; ++round) {
    const RobotHand hanging =
        HangingHand(drives, hand, GravityIn(X_WO * posture.X_HO.inverse()), posture.q);
    if ((hanging.tree.lower - posture.q).maxCoeff() < kClose) break;
    posture = SolveContactPosture(hanging, contacts);
  }
  return posture;
}

}  // namespace

Hold PlanHold(const RobotBody& body, const HumanHand& human, const Grasp& grasp,
              const GenerateOptions& generate) {
  constexpr double kOpen = 1;  // m, off the object: as far as the joints go
  // rad, off their stops: a finger that brushes a cylinder on the way yields.
  constexpr double kYielding = 0.06;
  Hold hold;
  hold.motion = GenerateMotion(grasp, generate);
  hold.closing = grasp.type == "lateral" ? PerFinger<bool>{true} : hold.motion.involved;
  hold.q_human = SolveHandMotionSmoothly(human, TipsOf(hold.motion), {.dt = generate.dt});
  const ContactRequest contacts = RequestContacts(
      human, body.hand, hold.motion, hold.q_human[ContactSample(hold.motion, generate.dt)]);
  hold.posture = SolveHangingPosture(body.hand, contacts, generate.X_WO);
  hold.q_open = HangingPosture(DrivesOf(body.hand), body.hand,
                               GravityIn(generate.X_WO * hold.posture.X_HO.inverse()),
                               OpenedHold(body.hand, hold, generate.shape, kOpen));
  if (grasp.type == "power") {
    for (int f = kIndex; f < kNumFingers; ++f) {
      for (const int j : {body.hand.fingers[f].j0, body.hand.fingers[f].j1}) {
        hold.q_open[j] = std::max(hold.q_open[j], body.hand.tree.lower[j] + kYielding);
      }
    }
  }
  return hold;
}

Eigen::VectorXd OpenedHold(const RobotHand& hand, const Hold& hold, const Shape& shape,
                           double clearance) {
  return OpenedPosture(hand, hold.posture, shape, hold.closing, clearance);
}

double SpareDistance(const RobotHand& hand, const Shape& shape, const Hold& hold) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, hold.posture.q, X_HB);
  PerFinger<bool> spare;
  for (int f = 0; f < kNumFingers; ++f) spare[f] = !hold.motion.involved[f];
  return HandDistance(hand, X_HB, hold.posture.X_HO.inverse(), shape, spare, true) - 1e-4;
}

void LetHang(const RobotHand& hand, const std::vector<Pose>& X_WH,
             std::vector<Eigen::VectorXd>& q) {
  const PneumaticHandModel drives = DrivesOf(hand);
  for (std::size_t i = 0; i < q.size(); ++i) {
    q[i] = HangingPosture(drives, hand, GravityIn(X_WH[i]), q[i]);
  }
}

}  // namespace springgrasp
