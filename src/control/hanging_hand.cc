#include "control/hanging_hand.h"

#include <vector>

namespace springgrasp {
namespace {

// Where the joints of the hand at `q` would balance with empty chambers.
Eigen::VectorXd Balance(const PneumaticHandModel& model, const RobotHand& hand,
                        const Eigen::Vector3d& g_H, const Eigen::VectorXd& q,
                        std::vector<Pose>& X_HB) {
  ForwardKinematics(hand.tree, q, X_HB);
  const ValveVector weight =
      model.gravity * MeanOfValves(model.layout, GravityTorques(hand.tree, X_HB, g_H));
  const ValveVector balance =
      model.return_rest + (weight + model.friction).cwiseQuotient(model.return_stiffness);
  Eigen::VectorXd of_joints(q.size());
  for (int j = 0; j < q.size(); ++j) of_joints[j] = balance[model.layout.valve_of_joint[j]];
  return of_joints;
}

}  // namespace

Eigen::VectorXd HangingPosture(const PneumaticHandModel& model, const RobotHand& hand,
                               const Eigen::Vector3d& g_H, const Eigen::VectorXd& q) {
  constexpr int kRounds = 30;
  constexpr double kPart = 0.5;   // of the way to the balance, per round
  constexpr double kDone = 1e-4;  // rad
  Eigen::VectorXd sunk = q;
  std::vector<Pose> X_HB;
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::VectorXd balance = Balance(model, hand, g_H, sunk, X_HB);
    const Eigen::VectorXd next =
        (sunk + kPart * (balance - sunk)).cwiseMax(q).cwiseMin(hand.tree.upper);
    const double step = (next - sunk).cwiseAbs().maxCoeff();
    sunk = next;
    if (step < kDone) break;
  }
  return sunk;
}

RobotHand HangingHand(const PneumaticHandModel& model, const RobotHand& hand,
                      const Eigen::Vector3d& g_H, const Eigen::VectorXd& q) {
  RobotHand hanging = hand;
  const Eigen::VectorXd sunk = HangingPosture(model, hand, g_H, q);
  std::vector<Pose> X_HB;
  const Eigen::VectorXd least = Balance(model, hand, g_H, sunk, X_HB).cwiseMin(hand.tree.upper);
  hanging.tree.lower = hanging.tree.lower.cwiseMax(least);
  hanging.open = hanging.open.cwiseMax(least);
  return hanging;
}

}  // namespace springgrasp
