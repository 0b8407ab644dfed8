// Where an object seats in the palm of the open hand, and how the fingers close on it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"
#include "kinematics/contact_posture.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

// How near the phalanges of one finger are, and where they would press.
struct FingerTouch {
  double proximal = 0, distal = 0;                        // gaps, m; negative: inside
  Eigen::Vector3d n_proximal = Eigen::Vector3d::UnitX();  // outward normals of the shape in O at
  Eigen::Vector3d n_distal = Eigen::Vector3d::UnitX();    // the nearest points
};
// `finger` -1: the palm, as `proximal`.
FingerTouch TouchOf(const RobotHand& hand, int finger, const Pose& X_OH, const Shape& shape,
                    const std::vector<Pose>& X_HB);

// Sum of the normals of the phalanges within `near` of the surface; zero if none is.
Eigen::Vector3d PressNormal(const FingerTouch& touch, double near);

// Whether one valve turns both joints of a finger: in free space by the same angle.
bool OnOneValve(const RobotHand& hand, int finger);

// Joints at which the finger touches the shape first when its proximal joint closes from open, with
// the distal joint bent beforehand. Of all bends the one is taken that brings both phalanges near
// or, if `wanted_n_O` is given, that touches where the surface looks along it (the thumb, to oppose
// the others). q of the other fingers is left alone. A finger on one valve closes with both joints
// alike. Returns the touch in that posture.
FingerTouch CloseFinger(const RobotHand& hand, int finger, const Pose& X_OH, const Shape& shape,
                        Eigen::VectorXd& q, const Eigen::Vector3d* wanted_n_O = nullptr);

// SolveContactPosture for type `power`.
ContactPosture SolvePowerPosture(const RobotHand& hand, const ContactRequest& request,
                                 const ContactPostureOptions& options);

}  // namespace springgrasp
