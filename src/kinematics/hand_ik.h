// Joint angles of the human hand from its fingertips (paper section III-C: "By solving the inverse
// kinematics problem for the MMM hand model, one obtains the joint angle configuration").
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "kinematics/human_hand.h"

namespace springgrasp {

// Fingertips of one instant; absent: not known, the finger keeps near its rest posture.
using KnownTips = PerFinger<std::optional<Eigen::Vector3d>>;

// Residual rows per finger, all of weight about 1 at the deviation given:
//   tip   (p - p_known) / tip_deviation                 3 rows, if known
//   rest  (q - q_rest) / rest_deviation                 one per joint
//   hold  (q - q_previous) / step_deviation             one per joint, if warm-started
//   link  (q_DIP - 2/3 q_PIP) / coupling_deviation      fingers only (human tendons)
struct HandIkOptions {
  double tip_deviation = 0.0005;   // m
  double rest_deviation = 4;       // rad
  double abduction_deviation = 1;  // rad; abduction stays nearer to rest than flexion
  double step_deviation = 0.05;    // rad, from one instant to the next
  double coupling_deviation = 2;   // rad
  int max_iterations = 40;
  // Pose variant: how far the wrist may be from its prior.
  double wrist_deviation = 0.02;  // m, from `X_WH_prior`
  double turn_deviation = 0.2;    // rad
};

struct HandIkResult {
  Eigen::VectorXd q;             // within the joint ranges, rad
  PerFinger<double> error = {};  // tip distance, m; 0 for unknown tips
};

// Tips in H. `previous` (may be empty: cold start) warm-starts and keeps the motion smooth.
HandIkResult SolveHandIk(const HumanHand& hand, const KnownTips& p_HF,
                         const Eigen::VectorXd& previous = {}, const HandIkOptions& options = {});

// A whole motion, each instant started from the one before; deterministic.
std::vector<Eigen::VectorXd> SolveHandMotion(const HumanHand& hand,
                                             const std::vector<KnownTips>& p_HF,
                                             const HandIkOptions& options = {});

// As SolveHandIk, but the wrist was not recorded: solves X_WH too, near a prior.
struct HandPoseIkResult {
  Pose X_WH = Pose::Identity();
  Eigen::VectorXd q;
  PerFinger<double> error = {};
};
HandPoseIkResult SolveHandPoseIk(const HumanHand& hand, const KnownTips& p_WF,
                                 const Pose& X_WH_prior, const Eigen::VectorXd& previous = {},
                                 const HandIkOptions& options = {});

// A prior for the wrist where none was recorded: the rest hand placed so that its thumb and index
// (or the first two known) tips meet the known ones, the rotation about their line by `up_W`
// (direction of the hand's back). Throws Error with fewer than two known tips.
Pose PriorHandPose(const HumanHand& hand, const KnownTips& p_WF, const Eigen::Vector3d& up_W);

}  // namespace springgrasp
