// An object that is held elsewhere in the hand than planned, on its way to the place; and whether
// it stands there in the end.
#pragma once

#include <string>
#include <vector>

#include "experiment/contact_window.h"
#include "experiment/grasp_plan.h"
#include "experiment/phases.h"
#include "kinematics/arm_ik.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

struct PlacePaths {
  std::vector<ArmVector> place, retreat;  // rad, at plan.dt
};

// Fingers that press carry the object off where it was planned to lie in the hand; their joints
// `q_hand` (rad) tell by how much. The plan's paths with the arm making up for it at the place, as
// planned if it cannot.
PlacePaths PathsForHeld(const Arm& arm, const RobotHand& hand, const GraspPlan& plan,
                        const HandVector& q_hand);

struct PlacedObject {
  double error = 0, tilt = 0;  // m, rad
  std::string fault;           // one line; empty: it stands where it shall, at rest and untouched
};

// `p_WO_before`: where it was `criteria.rest` seconds ago; `window`: contacts since then.
PlacedObject JudgePlaced(const Pose& X_WO, const Pose& X_WO_place,
                         const Eigen::Vector3d& p_WO_before, const ContactWindow& window,
                         const TrialCriteria& criteria);

}  // namespace springgrasp
