#include "vision/object_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springgrasp {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Interval {
  double enter = -kInfinity, leave = kInfinity;  // ray lengths, m
  void Clip(double a, double b) {
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
};

// Between the planes x = -half and x = half.
void ClipSlab(double p, double d, double half, Interval& inside) {
  if (std::abs(d) < 1e-12) {
    if (std::abs(p) > half) inside.leave = -kInfinity;
    return;
  }
  inside.Clip((-half - p) / d, (half - p) / d);
}

// Within `radius` of the origin, for p and d of two or three coordinates.
template <typename Vector>
void ClipBall(const Vector& p, const Vector& d, double radius, Interval& inside) {
  const double a = d.squaredNorm(), b = p.dot(d), c = p.squaredNorm() - radius * radius;
  if (a < 1e-24) {
    if (c > 0) inside.leave = -kInfinity;
    return;
  }
  const double root = b * b - a * c;
  if (root < 0) {
    inside.leave = -kInfinity;
    return;
  }
  inside.Clip((-b - std::sqrt(root)) / a, (-b + std::sqrt(root)) / a);
}

}  // namespace

std::optional<double> RayToShape(const Shape& shape, const Eigen::Vector3d& p_O,
                                 const Eigen::Vector3d& d_O) {
  Interval inside;
  const Eigen::Vector3d half = 0.5 * shape.size;
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      ClipBall(p_O, d_O, half.x(), inside);
      break;
    case Shape::Kind::kCylinder: {
      const Eigen::Vector2d p = p_O.head<2>(), d = d_O.head<2>();
      ClipBall(p, d, half.x(), inside);
      ClipSlab(p_O.z(), d_O.z(), half.z(), inside);
      break;
    }
    case Shape::Kind::kBox:
      for (int i = 0; i < 3; ++i) ClipSlab(p_O[i], d_O[i], half[i], inside);
      break;
  }
  if (inside.enter > inside.leave || inside.leave < 0) return std::nullopt;
  return std::max(0.0, inside.enter);
}

double ObjectDepth::At(const Eigen::Vector2d& pixel) const {
  const int j = static_cast<int>(std::lround(pixel.x() / step));
  const int i = static_cast<int>(std::lround(pixel.y() / step));
  if (i < 0 || j < 0 || i >= depth.rows || j >= depth.cols) return 1e9;
  return static_cast<double>(depth.at<float>(i, j));
}

ObjectDepth SeeObject(const CameraModel& camera, const DemonstratedObject& object, int step) {
  ObjectDepth seen;
  seen.step = step;
  seen.depth.create((camera.height + step - 1) / step, (camera.width + step - 1) / step, CV_32FC1);
  const Pose X_OW = object.X_WO.inverse();
  const Eigen::Vector3d p_O = X_OW * camera.X_WC.translation();
  const Eigen::Vector3d forward = camera.X_WC.linear().col(2);
  for (int i = 0; i < seen.depth.rows; ++i) {
    for (int j = 0; j < seen.depth.cols; ++j) {
      const Eigen::Vector3d ray = PixelRay(camera, Eigen::Vector2d(j * step, i * step));
      const auto length = RayToShape(object.shape, p_O, X_OW.linear() * ray);
      seen.depth.at<float>(i, j) = length ? static_cast<float>(*length * ray.dot(forward)) : 1e9f;
    }
  }
  return seen;
}

}  // namespace springgrasp
