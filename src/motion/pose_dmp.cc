#include <cmath>

#include "base/error.h"
#include "motion/dmp.h"
#include "motion/smoothing.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kTwoPi = 6.28318530717958647692;

Matrix3d Cross(const Vector3d& w) {
  Matrix3d W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W;
}

// J of d/dt Exp(w) = [J w']x Exp(w).
Matrix3d LeftJacobian(const Vector3d& w) {
  const double angle2 = w.squaredNorm();
  const double angle = std::sqrt(angle2);
  // Series where the closed form cancels.
  const double a = angle < 1e-4 ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
  const double b =
      angle < 1e-4 ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
  const Matrix3d W = Cross(w);
  return Matrix3d::Identity() + a * W + b * W * W;
}

// The rotation vector equal to w (up to whole turns) that lies nearest to `previous`.
Vector3d Unwrap(const Vector3d& w, const Vector3d& previous) {
  const double angle = w.norm();
  const Vector3d axis = angle > 1e-9 ? Vector3d(w / angle) : Vector3d(previous.normalized());
  const double turns = std::round((previous.dot(axis) - angle) / kTwoPi);
  return w + turns * kTwoPi * axis;
}

}  // namespace

MatrixXd PoseCoordinates(const std::vector<Pose>& X_WB, const Quaterniond& R_ref) {
  const auto m = static_cast<Index>(X_WB.size());
  MatrixXd x(m, 6);
  Vector3d previous = Vector3d::Zero();
  for (Index i = 0; i < m; ++i) {
    const Pose& X = X_WB[static_cast<std::size_t>(i)];
    const Vector3d w = LogRotation(R_ref.conjugate() * Quaterniond(X.linear()));
    previous = i == 0 ? w : Unwrap(w, previous);
    x.row(i) << X.translation().transpose(), previous.transpose();
  }
  return x;
}

Pose PoseFromCoordinates(const Eigen::Matrix<double, 6, 1>& x, const Quaterniond& R_ref) {
  return MakePose(x.head<3>(), R_ref * ExpRotation(x.tail<3>()));
}

PoseDmp LearnPoseDmp(const MotionSamples& coordinates, const Quaterniond& R_ref,
                     const DmpOptions& options) {
  ThrowUnless(coordinates.dimension() == 6, "pose primitive: {} coordinates, expected 6",
              coordinates.dimension());
  return {LearnDmp(coordinates, options), R_ref.normalized()};
}

PoseDmp LearnPoseDmp(const VectorXd& t, const std::vector<Pose>& X_WB, const DmpOptions& options) {
  ThrowUnless(!X_WB.empty() && t.size() == static_cast<Index>(X_WB.size()),
              "pose primitive: {} times, {} poses", t.size(), X_WB.size());
  const Quaterniond R_ref(X_WB.back().linear());
  return LearnPoseDmp(DifferentiateSamples(t, PoseCoordinates(X_WB, R_ref)), R_ref, options);
}

Pose StartPose(const PoseDmp& dmp) { return PoseFromCoordinates(dmp.motion.x0, dmp.R_ref); }

Pose GoalPose(const PoseDmp& dmp) { return PoseFromCoordinates(dmp.motion.g, dmp.R_ref); }

PoseDmp WithEndpoints(const PoseDmp& dmp, const Pose& X_WStart, const Pose& X_WGoal) {
  PoseDmp out = dmp;
  out.R_ref = (Quaterniond(X_WGoal.linear()) * ExpRotation(-dmp.motion.g.tail<3>())).normalized();
  const Vector3d w = LogRotation(out.R_ref.conjugate() * Quaterniond(X_WStart.linear()));
  out.motion.x0 << X_WStart.translation(), Unwrap(w, dmp.motion.x0.tail<3>());
  out.motion.g.head<3>() = X_WGoal.translation();
  return out;
}

PoseMotion RolloutPoseDmp(const PoseDmp& dmp, const VectorXd& times, const VectorXd& velocity0) {
  VectorXd v0 = velocity0;
  if (v0.size() != 0) {
    ThrowUnless(v0.size() == 6, "pose primitive: initial velocity has {} entries, expected 6",
                v0.size());
    const Vector3d w0 = dmp.motion.x0.tail<3>();
    v0.tail<3>() =
        LeftJacobian(w0).inverse() * (dmp.R_ref.conjugate() * Vector3d(velocity0.tail<3>()));
  }
  const MotionSamples motion = RolloutDmp(dmp.motion, times, v0);
  PoseMotion out;
  out.t = motion.t;
  out.velocity = motion.v;
  out.acceleration = motion.a.leftCols<3>();
  out.X_WB.reserve(static_cast<std::size_t>(motion.size()));
  for (Index i = 0; i < motion.size(); ++i) {
    const Eigen::Matrix<double, 6, 1> x = motion.x.row(i).transpose();
    const Vector3d wdot = motion.v.row(i).tail<3>().transpose();
    out.X_WB.push_back(PoseFromCoordinates(x, dmp.R_ref));
    out.velocity.row(i).tail<3>() =
        (dmp.R_ref * Vector3d(LeftJacobian(x.tail<3>()) * wdot)).transpose();
  }
  return out;
}

}  // namespace springgrasp
