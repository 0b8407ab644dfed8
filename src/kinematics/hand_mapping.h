// Robot finger joints from a human hand: the similarity of joint angles and fingertip position,
// minimised by Levenberg-Marquardt under joint bounds (Eq. (14)-(16)).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "kinematics/human_hand.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

// What the robot hand should resemble at one instant.
struct MappingTarget {
  PerFinger<Eigen::Vector2d> sigma;  // wanted j0, j1, rad (already clipped to the joint ranges)
  PerFinger<Eigen::Vector3d> p_HF;   // wanted tips in the robot's H, m
  PerFinger<double> lambda;          // weight of the position term (Eq. (14): 1)
  double opposition = 0;             // wanted angle of a thumb that can turn, rad
};

// Residual rows (n = 2 joints per finger):
//   2 per finger  (sigma_wanted - sigma) / (pi sqrt(n))                             Eq. (14)
//   3 per finger  sqrt(lambda) (p_wanted - p) / (2 l_finger sqrt(3))                Eq. (14)
//   palm          palm_weight (q_palm - palm_wanted) / pi                           ours
//   opposition    (q - opposition) / (pi sqrt(n)), if the hand has the joint        ours
//   every joint   smoothness (q - q_previous) / pi, if warm-started                 ours, off
// The unknowns are one angle per valve: joints of one chamber feel equal torque against equal
// springs, so that ring finger and pinkie bend all four joints alike. The palm moves four fingers,
// so that all fingers are solved at once.
struct MappingOptions {
  double palm_weight = 1;
  double palm_wanted = 0;  // rad
  double smoothness = 0;
  double max_step = 0;  // rad, of any joint from `previous` (bounds, as Eq. (16)); 0: no limit
  int max_iterations = 60;
};

struct MappingResult {
  Eigen::VectorXd q;                 // every joint, within its range, rad
  double cost = 0;                   // S' of Eq. (15) summed over fingers, plus our own rows
  PerFinger<double> tip_error = {};  // m
};

// Wanted joint angles and tips of the human posture: sigma by FlexionOf plus the hand's offsets,
// clipped; tips scaled by finger length about the base joints. lambda = 1.
MappingTarget TargetFromHuman(const HumanHand& human, const Eigen::VectorXd& q_human,
                              const RobotHand& robot);

// `previous` warm-starts (empty: starts from sigma).
MappingResult MapHand(const RobotHand& robot, const MappingTarget& target,
                      const Eigen::VectorXd& previous = {}, const MappingOptions& options = {});

// A whole trajectory: frame `anchor` from cold (the contact, where the posture matters), the others
// from there to both ends, each started from its neighbour, or on the way to another bend of a
// finger where that has become better.
std::vector<MappingResult> MapHandAlong(const RobotHand& robot,
                                        const std::vector<MappingTarget>& targets, int anchor,
                                        const MappingOptions& options = {});

// The same problem by NLopt (SLSQP): started as MapHand is, and from starts - 1 random ones.
MappingResult MapHandByNlopt(const RobotHand& robot, const MappingTarget& target, int starts,
                             const Eigen::VectorXd& previous = {},
                             const MappingOptions& options = {});

}  // namespace springgrasp
