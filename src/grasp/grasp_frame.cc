#include "grasp/grasp_frame.h"

#include <algorithm>

#include "base/error.h"

namespace springgrasp {
namespace {

// Mean tip of the involved fingers other than the thumb.
Eigen::Vector3d VirtualFinger(const PerFinger<Eigen::Vector3d>& p_AF,
                              const PerFinger<bool>& involved) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (int i = kIndex; i < kNumFingers; ++i) {
    if (!involved[i]) continue;
    sum += p_AF[i];
    ++count;
  }
  ThrowUnless(involved[kThumb] && count > 0,
              "grasp frame: the thumb and at least one more finger must be involved");
  return sum / count;
}

}  // namespace

Pose GraspFrame(const PerFinger<Eigen::Vector3d>& p_AF, const PerFinger<bool>& involved,
                const Eigen::Vector3d& p_AWrist) {
  const Eigen::Vector3d fingers = VirtualFinger(p_AF, involved);
  const Eigen::Vector3d origin = 0.5 * (p_AF[kThumb] + fingers);
  const Eigen::Matrix3d R = FrameFromXZ(fingers - p_AF[kThumb], p_AWrist - origin);
  return MakePose(origin, Eigen::Quaterniond(R));
}

InferredObject InferObject(const PerFinger<Eigen::Vector3d>& p_AF, const PerFinger<bool>& involved,
                           const Pose& X_AG, const Eigen::Vector3d& up_A, double tip_radius) {
  constexpr double kSmallest = 0.005;  // m; thinner grasps are tracking errors
  InferredObject object;
  const Eigen::Vector3d x = X_AG.linear().col(0);
  // A thumb straight below the finger leaves `up` without an orthogonal part: take G's z.
  const bool vertical = up_A.normalized().cross(x).norm() < 0.1;
  const Eigen::Matrix3d R = FrameFromXZ(x, vertical ? Eigen::Vector3d(X_AG.linear().col(2)) : up_A);
  object.X_AO = MakePose(X_AG.translation(), Eigen::Quaterniond(R));
  const double span = (VirtualFinger(p_AF, involved) - p_AF[kThumb]).norm();
  object.shape.kind = Shape::Kind::kSphere;
  object.shape.size.setConstant(std::max(kSmallest, span - 2 * tip_radius));
  return object;
}

PerFinger<bool> InvolvedFingers(const std::string& type) {
  if (type == "pinch" || type == "lateral") return {true, true, false, false, false};
  if (type == "tripod") return {true, true, true, false, false};
  if (type == "power") return {true, true, true, true, true};
  Fail("grasp type '{}': expected pinch, tripod, power or lateral", type);
}

}  // namespace springgrasp
