#include "kinematics/arm_ik.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "kinematics/arm_choice.h"
#include "kinematics/arm_ik_numeric.h"
#include "kinematics/arm_swivel.h"

namespace springgrasp {
namespace {

constexpr double kNumericStepWeight = 0.3;  // of a joint step while tracking, per rad

ArmPreference NearTo(const Eigen::VectorXd& q, const ArmIkOptions& options) {
  ArmPreference preference;
  preference.limit = 0.1 * options.limit_weight;
  preference.elbow = 0.05 * options.limit_weight;
  preference.step = 1;
  preference.near = q;
  return preference;
}

}  // namespace

Arm MakeArm(const KinematicTree& tree, const std::string& frame, const std::string& prefix,
            const Eigen::VectorXd& q, bool torso) {
  Arm arm;
  arm.tree = tree;
  arm.frame = tree.FrameIndex(frame);
  arm.q = q;
  ThrowUnless(q.size() == tree.num_joints(), "an arm's posture has {} values for {} joints",
              q.size(), tree.num_joints());
  for (const char* wanted : {"torso_", prefix.c_str()}) {
    if (!torso && std::string(wanted) == "torso_") continue;
    for (int j = 0; j < tree.num_joints(); ++j) {
      if (tree.joint_names[j].starts_with(wanted)) arm.joints.push_back(j);
    }
  }
  ThrowUnless(!arm.joints.empty(), "no joint of the tree begins with '{}'", prefix);
  return arm;
}

Pose HandPose(const Arm& arm, const Eigen::VectorXd& q) {
  Eigen::VectorXd full = arm.q;
  for (int i = 0; i < arm.num_joints(); ++i) full[arm.joints[i]] = q[i];
  std::vector<Pose> X_WB;
  ForwardKinematics(arm.tree, full, X_WB);
  return FramePose(arm.tree, X_WB, arm.frame);
}

double LimitMargin(const Arm& arm, const Eigen::VectorXd& q) {
  double margin = 1;
  for (int i = 0; i < arm.num_joints(); ++i) {
    const double low = arm.tree.lower[arm.joints[i]], high = arm.tree.upper[arm.joints[i]];
    margin = std::min(margin, 2 * std::min(q[i] - low, high - q[i]) / (high - low));
  }
  return margin;
}

std::optional<Eigen::VectorXd> SolveArmIk(const Arm& arm, const Pose& X_WH,
                                          const Eigen::VectorXd& start,
                                          const ArmIkOptions& options) {
  const std::optional<ArmGeometry> geometry = GeometryOf(arm);
  if (!geometry) return SolveArmNumerically(arm, X_WH, start, options, 0);
  ArmSolutions solutions;
  solutions.Solve(*geometry, X_WH, options.margin);
  const std::optional<ArmChoice> choice =
      ChoosePosture(*geometry, solutions, NearTo(start, options));
  if (!choice) return std::nullopt;
  return choice->q;
}

std::optional<Eigen::VectorXd> SolveArmIkFromAnywhere(const Arm& arm, const Pose& X_WH,
                                                      const ArmIkOptions& options,
                                                      const std::optional<Eigen::VectorXd>& near) {
  const std::optional<ArmGeometry> geometry = GeometryOf(arm);
  if (!geometry) return SolveArmNumericallyFromAnywhere(arm, X_WH, options, near);
  ArmPreference preference;
  if (near) {
    preference.near = *near;
    preference.step = options.near_weight;
  }
  ArmSolutions solutions;
  solutions.Solve(*geometry, X_WH, options.margin);
  const std::optional<ArmChoice> choice = ChoosePosture(*geometry, solutions, preference);
  if (!choice) return std::nullopt;
  return choice->q;
}

ArmPath TrackArmPath(const Arm& arm, const std::vector<Pose>& X_WH, const Eigen::VectorXd& start,
                     double max_step, const ArmIkOptions& options) {
  ArmPath path;
  const std::optional<ArmGeometry> geometry = GeometryOf(arm);
  ArmSolutions solutions;
  Eigen::VectorXd q = start;
  for (std::size_t k = 0; k < X_WH.size(); ++k) {
    std::optional<Eigen::VectorXd> next;
    if (geometry) {
      solutions.Solve(*geometry, X_WH[k], options.margin);
      const auto choice = ChoosePosture(*geometry, solutions, NearTo(q, options));
      if (choice) next = choice->q;
    } else {
      next = SolveArmNumerically(arm, X_WH[k], q, options, kNumericStepWeight);
    }
    if (!next) {
      path.reason = fmt::format("the arm cannot follow beyond sample {} of {}", k, X_WH.size());
      return path;
    }
    const double step = (*next - q).cwiseAbs().maxCoeff();
    if (k > 0 && step > max_step) {
      path.reason =
          fmt::format("the arm would jump by {:.2f} rad at sample {} of {}", step, k, X_WH.size());
      return path;
    }
    if (k > 0) path.max_step = std::max(path.max_step, step);
    path.q.push_back(*next);
    q = *next;
  }
  path.complete = true;
  return path;
}

}  // namespace springgrasp
