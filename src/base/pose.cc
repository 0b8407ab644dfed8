#include "base/pose.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace springgrasp {

Pose MakePose(const Eigen::Vector3d& p_AB, const Eigen::Quaterniond& R_AB) {
  Pose X_AB = Pose::Identity();
  X_AB.linear() = R_AB.normalized().toRotationMatrix();
  X_AB.translation() = p_AB;
  return X_AB;
}

Pose PoseFromArray(const double* a) {
  return MakePose({a[0], a[1], a[2]}, Eigen::Quaterniond(a[3], a[4], a[5], a[6]));
}

Eigen::Matrix<double, 7, 1> PoseToArray(const Pose& X_AB) {
  Eigen::Quaterniond q(X_AB.linear());
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  Eigen::Matrix<double, 7, 1> a;
  a << X_AB.translation(), q.w(), q.x(), q.y(), q.z();
  return a;
}

Eigen::Vector3d LogRotation(const Eigen::Quaterniond& R) {
  const double sign = R.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * R.vec();
  const double sine = v.norm();
  const double angle = 2 * std::atan2(sine, sign * R.w());
  return sine < 1e-12 ? Eigen::Vector3d(2 * v) : Eigen::Vector3d(v * (angle / sine));
}

Eigen::Quaterniond ExpRotation(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const double scale = angle < 1e-12 ? 0.5 : std::sin(angle / 2) / angle;
  Eigen::Quaterniond q;
  q.w() = std::cos(angle / 2);
  q.vec() = scale * w;
  return q.normalized();
}

Pose Interpolate(const Pose& a, const Pose& b, double u) {
  return MakePose((1 - u) * a.translation() + u * b.translation(),
                  Eigen::Quaterniond(a.linear()).slerp(u, Eigen::Quaterniond(b.linear())));
}

Pose PoseAlong(const std::vector<Pose>& path, double index) {
  const std::size_t last = path.size() - 1;
  const double s = std::clamp(index, 0.0, static_cast<double>(last));
  const auto i = static_cast<std::size_t>(s);
  return Interpolate(path[i], path[std::min(i + 1, last)], s - static_cast<double>(i));
}

double RotationDistance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return LogRotation(a.conjugate() * b).norm();
}

Eigen::Matrix3d FrameFromXZ(const Eigen::Vector3d& x, const Eigen::Vector3d& z_hint) {
  ThrowUnless(x.norm() > 1e-12, "a frame needs a non-zero x axis");
  Eigen::Matrix3d R;
  R.col(0) = x.normalized();
  const Eigen::Vector3d z = z_hint - R.col(0) * R.col(0).dot(z_hint);
  ThrowUnless(z.norm() > 1e-9 * std::max(1.0, z_hint.norm()),
              "a frame needs a z axis that is not parallel to its x axis");
  R.col(2) = z.normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return R;
}

}  // namespace springgrasp
