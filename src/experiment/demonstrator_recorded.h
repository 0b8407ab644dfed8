// A recorded human grasp, put on the MMM hand so that it can be shown to the cameras.
#pragma once

#include <string>

#include "demonstration/demonstration.h"
#include "demonstration/hand_motion.h"
#include "experiment/demonstrator_hand.h"

namespace springgrasp {

// Joint angles by inverse kinematics at every recorded instant. Assumed, and noted in `comments`:
// - short gaps of a marker are bridged by a straight line (in the hand frame where there is a
// wrist);
// - the recording's hand frame is fixed to H by a constant that is fitted to the fingertips, within
//   5 cm and 30 degrees of H;
// - without a wrist the hand reaches along the movement, its thumb and index on the markers, turned
//   about their line as a hand is that points where it goes;
// - thumb and fingers keep two cap radii apart, where the bare fingertips came nearer;
// - fingers that were not recorded rest half curled.
// `type` names the grasp ("" : by the recorded fingers). What is shown is the hand's own motion;
// per sample and finger a flag says whether it was measured. Throws Error without thumb and index.
HandMotion HandMotionOf(const DemonstratorHand& hand, const Demonstration& recording,
                        const std::string& type = "");

}  // namespace springgrasp
