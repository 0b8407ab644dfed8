#include "experiment/arm_reference.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

template <typename Vector, typename Reference>
void Interpolate(const std::vector<Vector>& path, double dt, double t, Reference& reference) {
  const double s = std::clamp(t / dt, 0.0, static_cast<double>(path.size() - 1));
  const long i = static_cast<long>(s);
  const double u = s - static_cast<double>(i);
  const auto at = [&](long k) -> const Vector& {
    return path[static_cast<std::size_t>(
        std::clamp<long>(k, 0, static_cast<long>(path.size()) - 1))];
  };
  const auto velocity = [&](long k) -> Vector { return (at(k + 1) - at(k - 1)) / (2 * dt); };
  const auto acceleration = [&](long k) -> Vector {
    return (at(k + 1) - 2 * at(k) + at(k - 1)) / (dt * dt);
  };
  reference.q = (1 - u) * at(i) + u * at(i + 1);
  reference.qd = (1 - u) * velocity(i) + u * velocity(i + 1);
  reference.qdd = (1 - u) * acceleration(i) + u * acceleration(i + 1);
  if (t >= dt * static_cast<double>(path.size() - 1)) {
    reference.qd.setZero();
    reference.qdd.setZero();
  }
}

}  // namespace

ArmTarget ArmReferenceAt(const std::vector<ArmVector>& path, double dt, double t) {
  ArmTarget target;
  Interpolate(path, dt, t, target);
  return target;
}

HandReference HandReferenceAt(const std::vector<HandVector>& path, double dt, double t) {
  HandReference reference;
  Interpolate(path, dt, t, reference);
  return reference;
}

ArmVector LoadTorque(const Arm& arm, const ArmVector& q, const Pose& X_HO, double mass) {
  constexpr double kGravity = 9.81;  // m/s^2
  // The rest of the robot may have joints too, which carry it by themselves.
  Eigen::VectorXd full = arm.q;
  for (int i = 0; i < arm.num_joints(); ++i) full[arm.joints[i]] = q[i];
  std::vector<Pose> X_WB;
  ForwardKinematics(arm.tree, full, X_WB);
  Eigen::MatrixXd J(6, arm.tree.num_joints());
  FrameJacobian(arm.tree, X_WB, arm.frame, J);
  const Eigen::Vector3d lever = FramePose(arm.tree, X_WB, arm.frame).linear() * X_HO.translation();
  const Eigen::Vector3d force(0, 0, mass * kGravity);
  const Eigen::VectorXd torque =
      J.topRows<3>().transpose() * force + J.bottomRows<3>().transpose() * lever.cross(force);
  return torque(arm.joints);
}

}  // namespace springgrasp
