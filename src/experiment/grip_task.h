// What a trial asks of the grip controller, by what the robot believes.
#pragma once

#include "control/grip_controller.h"
#include "experiment/grasp_plan.h"
#include "experiment/perform.h"

namespace springgrasp {

// Fingers, direction and force (N) of the grip: that of weight, friction and safety factor, at
// least the smallest that suits the type.
GripTask GripTaskOf(const GraspPlan& plan, const RobotHand& hand, const PerformOptions& options);

// The model of the drives that the controllers work with, wrong by what the options say.
PneumaticHandModel BelievedHand(const HandLayout& layout, const PerformOptions& options);

// The pads' frames of a hand's tree.
PerFinger<int> TipFrames(const KinematicTree& hand);

}  // namespace springgrasp
