// Grip torques: how hard the fingers press, and along what, once they are on the object.
#pragma once

#include <Eigen/Core>
#include <string>

#include "base/fingers.h"
#include "control/robot_state.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// Opposing thumb and virtual finger [Arbib et al., the paper's [15]]: the thumb presses with
// `force` along the line to the mean of the other involved pads, these press back with equal and
// opposite total.
struct FingertipGrip {
  PerFinger<bool> involved = {};
  double force = 3;  // N, of the thumb
};

// Joint torques J' F of a fingertip grip at posture q of the hand (tree with root H; frames
// hand_?_<finger>_tip given by index). Nm, in the order of q.
HandVector FingertipGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                               const HandVector& q, const FingertipGrip& grip);

// Joint torques of an enclosing grip: every flexion joint of the involved fingers presses with
// `proximal` or `distal` torque, the palm with `palm` (Nm).
struct EnclosingGrip {
  PerFinger<bool> involved = {};
  double proximal = 0.3, distal = 0.25, palm = 0.1;
  double thumb_distal =
      0.1;  // the thumb presses with its base: bent in, it would cross the fingers
};
HandVector EnclosingGripTorque(const EnclosingGrip& grip, int num_joints);

// Thumb force that holds a mass against its weight and `acceleration` by friction of two opposed
// contacts, times a safety factor; N.
double GripForceFor(double mass, double friction, double acceleration, double safety,
                    double max_force);

}  // namespace springgrasp
