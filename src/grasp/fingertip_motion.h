// MOTION: what a grasp of the library becomes for one object, before any robot is known.
#pragma once

#include <string>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"

namespace springgrasp {

struct FingertipMotionSample {
  double t = 0;                     // s, 0 at the start of the reach
  Pose X_WG = Pose::Identity();     // grasp frame G from the DMP
  Pose X_WH = Pose::Identity();     // human hand frame H = X_WG * X_GH (demonstrated)
  double f_cen = 0;                 // central force, N (Eq. (7))
  PerFinger<Eigen::Vector3d> p_HF;  // fingertips in H from the springs (Eq. (5)), m
};

struct FingertipMotion {
  std::string type;                 // pinch | tripod | power | lateral
  PerFinger<bool> involved = {};    // the paper's c(i)
  Shape shape;                      // the new object
  Pose X_WO = Pose::Identity();     // its believed pose
  Pose X_HO = Pose::Identity();     // object in H at the end of the reach (contacts at rest in H)
  Pose X_HG = Pose::Identity();     // demonstrated G in H at contact
  PerFinger<Eigen::Vector3d> p_OC;  // contact points c_i in O (tip centres when touching), m
  PerFinger<Eigen::Vector3d> n_OC;  // outward surface normals at the contacts, unit
  double hand_length = 0.189;       // m, of the demonstrating hand
  double T = 0;                     // s, duration of the reach (tau of the DMP)
  double t_switch = 0;              // s, sign change of f_cen
  std::vector<FingertipMotionSample> samples;  // even steps, from 0 to 1.5 T
};

// Columns: t, f_cen, G pose, H pose, then fingertips in world X_WH(t) p_HF(t).
std::string FormatFingertipMotion(const FingertipMotion& motion);

}  // namespace springgrasp
