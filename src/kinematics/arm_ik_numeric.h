// Inverse kinematics of any chain by Levenberg-Marquardt: for arms that move with the torso, or
// that have no closed form.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "kinematics/arm_ik.h"

namespace springgrasp {

// Pulls towards mid-range (weight `limit_weight` at a limit) and towards the start (`step_weight`
// per rad), then reaches the pose exactly from there.
std::optional<Eigen::VectorXd> SolveArmNumerically(const Arm& arm, const Pose& X_WH,
                                                   const Eigen::VectorXd& start,
                                                   const ArmIkOptions& options, double step_weight);

// From several deterministic starts, see SolveArmIkFromAnywhere.
std::optional<Eigen::VectorXd> SolveArmNumericallyFromAnywhere(
    const Arm& arm, const Pose& X_WH, const ArmIkOptions& options,
    const std::optional<Eigen::VectorXd>& near);

}  // namespace springgrasp
