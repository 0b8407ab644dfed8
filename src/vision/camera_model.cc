#include "vision/camera_model.h"

#include <Eigen/Dense>
#include <cmath>

namespace springgrasp {
namespace {

// Distortion of OpenCV's rational model: normalised undistorted xy to distorted, with derivative.
Eigen::Vector2d Distort(const CameraModel& camera, const Eigen::Vector2d& n, Eigen::Matrix2d* J) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  const double x = n.x(), y = n.y(), r2 = n.squaredNorm();
  const double top = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double bottom = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
  const double radial = top / bottom;
  if (J != nullptr) {
    const double dtop = k1 + r2 * (2 * k2 + r2 * 3 * k3);
    const double dbottom = k4 + r2 * (2 * k5 + r2 * 3 * k6);
    const double dradial = (dtop - radial * dbottom) / bottom;  // with respect to r2
    (*J)(0, 0) = radial + 2 * x * x * dradial + 2 * p1 * y + 6 * p2 * x;
    (*J)(0, 1) = 2 * x * y * dradial + 2 * p1 * x + 2 * p2 * y;
    (*J)(1, 0) = (*J)(0, 1);
    (*J)(1, 1) = radial + 2 * y * y * dradial + 6 * p1 * y + 2 * p2 * x;
  }
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

// Normalised undistorted coordinates of a pixel.
Eigen::Vector2d Normalise(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d d((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
  if (!camera.distorted()) return d;
  Eigen::Vector2d n = d;
  Eigen::Matrix2d J;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector2d error = Distort(camera, n, &J) - d;
    if (error.squaredNorm() < 1e-22 || std::abs(J.determinant()) < 1e-9) break;
    n -= J.inverse() * error;
  }
  return n;
}

}  // namespace

bool CameraModel::distorted() const {
  for (double k : distortion) {
    if (k != 0) return true;
  }
  return false;
}

CameraModel PinholeCamera(int width, int height, const Eigen::Matrix3d& K, const Pose& X_WC) {
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.fx = K(0, 0);
  camera.fy = K(1, 1);
  camera.cx = K(0, 2);
  camera.cy = K(1, 2);
  camera.X_WC = X_WC;
  return camera;
}

std::optional<Eigen::Vector2d> Project(const CameraModel& camera, const Eigen::Vector3d& p_WQ,
                                       Eigen::Matrix<double, 2, 3>* J) {
  const Eigen::Matrix3d R_CW = camera.X_WC.linear().transpose();
  const Eigen::Vector3d p_CQ = R_CW * (p_WQ - camera.X_WC.translation());
  if (!(p_CQ.z() > 1e-3)) return std::nullopt;
  Eigen::Vector2d n = p_CQ.head<2>() / p_CQ.z();
  Eigen::Matrix2d D = Eigen::Matrix2d::Identity();
  const Eigen::Vector2d straight = n;
  if (camera.distorted()) n = Distort(camera, n, J != nullptr ? &D : nullptr);
  if (J != nullptr) {
    Eigen::Matrix<double, 2, 3> P;
    P << 1, 0, -straight.x(), 0, 1, -straight.y();
    *J = Eigen::Vector2d(camera.fx, camera.fy).asDiagonal() * D * P * R_CW / p_CQ.z();
  }
  return Eigen::Vector2d(camera.fx * n.x() + camera.cx, camera.fy * n.y() + camera.cy);
}

std::optional<Eigen::Vector2d> Project(const CameraModel& camera, const Eigen::Vector3d& p_WQ) {
  return Project(camera, p_WQ, nullptr);
}

Eigen::Vector3d PixelRay(const CameraModel& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d n = Normalise(camera, pixel);
  return (camera.X_WC.linear() * Eigen::Vector3d(n.x(), n.y(), 1)).normalized();
}

std::optional<TriangulatedPoint> Triangulate(const StereoCameras& cameras,
                                             const Eigen::Vector2d& left,
                                             const Eigen::Vector2d& right) {
  const Eigen::Vector3d p_L = cameras.left.X_WC.translation();
  const Eigen::Vector3d p_R = cameras.right.X_WC.translation();
  const Eigen::Vector3d a = PixelRay(cameras.left, left), b = PixelRay(cameras.right, right);
  const double ab = a.dot(b), sine2 = 1 - ab * ab;
  if (sine2 < 1e-10) return std::nullopt;
  const Eigen::Vector3d w = p_R - p_L;
  const double s = (a.dot(w) - ab * b.dot(w)) / sine2;
  const double t = (ab * a.dot(w) - b.dot(w)) / sine2;
  TriangulatedPoint point;
  point.p_WQ = 0.5 * (p_L + s * a + p_R + t * b);
  for (int step = 0; step < 4; ++step) {
    Eigen::Matrix<double, 4, 3> J;
    Eigen::Vector4d r;
    for (int view = 0; view < 2; ++view) {
      Eigen::Matrix<double, 2, 3> J_view;
      const auto pixel = Project(cameras.view(view), point.p_WQ, &J_view);
      if (!pixel) return std::nullopt;
      J.middleRows<2>(2 * view) = J_view;
      r.segment<2>(2 * view) = *pixel - (view == 0 ? left : right);
    }
    point.residual_px = std::sqrt(r.squaredNorm() / 4);
    if (step < 3) point.p_WQ -= (J.transpose() * J).ldlt().solve(J.transpose() * r);
  }
  return point;
}

double EpipolarDistance(const StereoCameras& cameras, const Eigen::Vector2d& left,
                        const Eigen::Vector2d& right) {
  // Normal of the epipolar plane, seen from the right camera: its trace is the line.
  const Eigen::Vector3d base = cameras.right.X_WC.translation() - cameras.left.X_WC.translation();
  const Eigen::Vector3d normal_R =
      cameras.right.X_WC.linear().transpose() * base.cross(PixelRay(cameras.left, left));
  const Eigen::Vector3d ray_W = PixelRay(cameras.right, right);
  const Eigen::Vector3d ray_R = cameras.right.X_WC.linear().transpose() * ray_W;
  const double across =
      std::hypot(normal_R.x() / cameras.right.fx, normal_R.y() / cameras.right.fy);
  return across < 1e-15 ? 0 : std::abs(normal_R.dot(ray_R / ray_R.z())) / across;
}

}  // namespace springgrasp
