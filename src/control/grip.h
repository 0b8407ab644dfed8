// Grip torques: how hard the fingers press, and along what, once they are on the object.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/fingers.h"
#include "control/robot_state.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {

// All below allocate nothing: the poses X_HB of the hand's bodies at its posture come from
// ForwardKinematics.
using HandJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxHandJoints>;
using HandDirections =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxHandJoints, kNumFingers>;

// Torques of a grip, and the force of each finger on the object that they ask for.
struct GripTorque {
  HandVector torque;             // Nm
  PerFinger<double> force = {};  // N
};

// Opposing thumb and virtual finger [Arbib et al., the paper's [15]]: the thumb presses with
// `force` along the line to the mean of the other involved pads, these press back with equal and
// opposite total.
struct FingertipGrip {
  PerFinger<bool> involved = {};
  double force = 3;  // N, of the thumb
  // Of the opposed fingers in that force, up to a factor; the forces reported are those of even
  // shares.
  PerFinger<double> share = {1, 1, 1, 1, 1};
};

// Joint torques J' F of a fingertip grip of the hand (tree with root H; frames hand_?_<finger>_tip
// given by index), in the order of its joints.
GripTorque FingertipGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                               const std::vector<Pose>& X_HB, const FingertipGrip& grip);

// A key grip: the thumb alone presses with `force` (N) along `push_H` (unit) on what lies on the
// side of another finger, whose joints have no torque against it.
GripTorque KeyGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                         const std::vector<Pose>& X_HB, const Eigen::Vector3d& push_H,
                         double force);

// Directions in joint space in which a fingertip grip closes: one for each finger opposed to the
// thumb, orthonormal columns.
HandDirections ClosingDirections(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                                 const std::vector<Pose>& X_HB, const PerFinger<bool>& involved);

// An enclosing grip: the fingers press with their last phalanx what thumb and palm hold against.
// The last joints of all fingers have the same torque, as one valve may bend several, so that the
// shorter of them press harder; `force` (N) is that of all together, and of the thumb.
struct EnclosingGrip {
  PerFinger<bool> involved = {};
  double force = 12;
  // Of the last joints' torque: proximal joints, thumb's base, its last joint, palm. The thumb
  // presses with its base: bent in, it would cross the fingers.
  double proximal = 1.25, thumb_proximal = 1.25, thumb_distal = 0.25, palm = 0.625;
};
GripTorque EnclosingGripTorque(const KinematicTree& hand, const PerFinger<int>& tip_frames,
                               const std::vector<Pose>& X_HB, const EnclosingGrip& grip);

// Thumb force that holds a mass against its weight and `acceleration` by friction of two opposed
// contacts, times a safety factor; N.
double GripForceFor(double mass, double friction, double acceleration, double safety,
                    double max_force);

}  // namespace springgrasp
