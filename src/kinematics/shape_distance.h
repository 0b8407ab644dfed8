// Signed distances to the shapes that perception is assumed to know.
#pragma once

#include <Eigen/Core>

#include "base/pose.h"
#include "base/shape.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

// Distance of a point to the surface, negative inside, m; `gradient` (optional): unit, outward.
double SignedDistance(const Shape& shape, const Eigen::Vector3d& p_OQ,
                      Eigen::Vector3d* gradient = nullptr);

// Smallest distance of a capsule's surface to the shape, sampled along its axis every few mm.
double CapsuleDistance(const Shape& shape, const Eigen::Vector3d& p_OA, const Eigen::Vector3d& p_OB,
                       double radius);

// Smallest distance between the shape and the hand's capsules, m; negative: penetration.
// `fingers`: which fingers count (palm always does when `palm`).
double HandDistance(const RobotHand& hand, const std::vector<Pose>& X_HB, const Pose& X_OH,
                    const Shape& shape, const PerFinger<bool>& fingers, bool palm);

}  // namespace springgrasp
