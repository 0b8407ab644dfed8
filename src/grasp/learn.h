// Learning a grasp from one demonstration: DMP of the reach, contacts, spring constants
// (paper section II; system contract section 5).
#pragma once

#include <optional>
#include <string>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"
#include "demonstration/demonstration.h"
#include "grasp/grasp.h"

namespace springgrasp {

struct LearnOptions {
  std::string name;            // of the library entry; empty: the type
  std::string type = "pinch";  // pinch | tripod | power | lateral
  int dim = 3;                 // 2: the paper's plane, 3
  // human: delay and closing gain fitted; paper: 0 and 1; unforced: as paper
  // with f_cen = 0
  std::string profile = "human";
  std::optional<DemonstratedObject> object;  // overrides the demonstration's; X_WO in its frame
  double hand_length = 0.189;                // m, scales the relaxed tips and their radius
  double tip_radius = 0.008;                 // m, of the demonstrating fingers at 0.189 m
  // Fingertips of the relaxed hand in H at a hand length of 0.189 m: rest lengths, and fingers
  // that were never seen. Default: DefaultRelaxedTips().
  std::optional<PerFinger<Eigen::Vector3d>> relaxed_tips;
  // Grasp frame in H where no wrist was recorded. Default: DefaultGraspInHand().
  std::optional<Pose> X_HG_nominal;
  int basis_functions = 20;  // of the DMP
};

// The hand is steadied first (demonstration/steady_hand.h). Throws Error (one line) if the
// demonstration has too little to learn from: no thumb, no other involved finger, no movement.
Grasp LearnGrasp(const Demonstration& shown, const LearnOptions& options);

inline constexpr double kNominalHandLength = 0.189;  // m, of the MMM hand at 1.75 m

// Tips of a relaxed right hand in H, m, at the nominal length.
PerFinger<Eigen::Vector3d> DefaultRelaxedTips();
// Grasp frame in H of a pinch, for a hand length of 0.189 m.
Pose DefaultGraspInHand();

}  // namespace springgrasp
