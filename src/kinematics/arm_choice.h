// Which of an arm's solutions to take: the elbow's posture, the joint ranges, and where it was.
#pragma once

#include <optional>

#include "kinematics/arm_swivel.h"

namespace springgrasp {

// Cost of a posture: limit * sum of z^4 (z: 0 in mid range, 1 at a limit)
//   + elbow * (height of the elbow, 0 lowest, 1 highest of what the hand pose allows)
//   + step * |q - near|^2.
struct ArmPreference {
  double limit = 1;
  double elbow = 0.5;
  double step = 0;  // per rad^2
  SevenJoints near = SevenJoints::Zero();
};

double ArmCost(const ArmGeometry& geometry, const ArmSolutions& solutions,
               const SwivelInterval& branch, double swivel, const SevenJoints& q,
               const ArmPreference& preference);

struct ArmChoice {
  SwivelInterval branch;
  double swivel = 0;
  SevenJoints q = SevenJoints::Zero();
  double cost = 0;
};

// The cheapest posture of all branches; absent if the pose has none.
std::optional<ArmChoice> ChoosePosture(const ArmGeometry& geometry, const ArmSolutions& solutions,
                                       const ArmPreference& preference);

}  // namespace springgrasp
