#include "experiment/grasp_plan.h"

namespace springgrasp {

Pose PlannedHandPose(const GraspPlan& plan, double t) { return PoseAlong(plan.X_WH, t / plan.dt); }

Eigen::Vector3d PlannedTipInHand(const GraspPlan& plan, std::size_t sample, int finger) {
  return plan.X_WH[sample].inverse() * plan.p_WF[sample][finger];
}

}  // namespace springgrasp
