// The posture in which the robot hand holds the object: where the object lies in the hand, and the
// finger joints that put the pads on the contacts.
#pragma once

#include <Eigen/Core>
#include <string>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"
#include "kinematics/hand_mapping.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

struct ContactRequest {
  std::string type = "pinch";  // pinch | tripod | power | lateral
  PerFinger<bool> involved = {};
  Shape shape;
  PerFinger<Eigen::Vector3d> p_OC;     // tip centres when touching (robot's tip radius), m
  PerFinger<Eigen::Vector3d> n_OC;     // outward normals
  Pose X_OG = Pose::Identity();        // demonstrated grasp frame in O at contact
  Pose X_OH_human = Pose::Identity();  // demonstrated hand in O at contact: where the palm looks
  MappingTarget human;                 // demonstrated posture at contact (TargetFromHuman)
};

struct ContactPostureOptions {
  double clearance = 0.010;  // m, of uninvolved fingers from the object
  double palm_gap = 0.002;   // m, between object and palm in a power grasp
  double max_slide = 0.015;  // m, how far contacts may slide on the object
  double squeeze = 0;        // m, pads planned this far into the surface
};

struct ContactPosture {
  Pose X_HO = Pose::Identity();     // object in the robot's hand
  Pose X_HG = Pose::Identity();     // grasp frame of the robot at contact (system contract 4)
  Eigen::VectorXd q;                // hand joints at contact, rad
  PerFinger<Eigen::Vector3d> p_OC;  // contacts after sliding: planned tip centres in O, m
  PerFinger<double> gap = {};       // involved fingers: surface distance of the finger (power:
                                    // of its nearest phalanx) from the object, m
  double slide = 0;                 // largest distance from the asked contacts, m
  double penetration = 0;           // deepest of any link or palm, m (0: none)
  double opposition_deg = 0;        // angle between the thumb's normal and the others' mean
  double clearance = 0;             // of uninvolved fingers, m
  double cost = 0;                  // of the optimum, to compare candidates
};

// Deterministic: a fixed set of starts. Always returns its best posture; judge it by the fields
// (a plan is fair with gap and penetration below 1 mm and opposition above 150 degrees).
// Fingertip types solve X_HO and joints at once by Levenberg-Marquardt: pads touch, thumb opposes,
// contacts move only as far as they must, the wrist lies where the demonstrated one lay (G). Power
// searches where the object seats in the palm, then closes each finger until it touches.
// Throws Error for an unknown type or without thumb.
ContactPosture SolveContactPosture(const RobotHand& hand, const ContactRequest& request,
                                   const ContactPostureOptions& options = {});

// The frame about which a hand in this posture can turn and keep its contacts: at the thumb's
// contact, x along its push, z as near to G's as may be; in H. On flat faces the contacts slide off
// the demonstrated line, so that x is not G's.
Pose ContactFrame(const Shape& shape, const ContactPosture& posture);

// Fills what can be measured of a posture (X_HG, p_OC, gap, slide, penetration, ...) from its X_HO
// and q.
void JudgePosture(const RobotHand& hand, const ContactRequest& request, ContactPosture& posture);

}  // namespace springgrasp
