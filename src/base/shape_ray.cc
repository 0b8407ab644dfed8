#include "base/shape_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springgrasp {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTiny = 1e-12;

// Narrows the span to where |origin + s * direction| <= half on one axis; false if nothing is left.
bool ClipSlab(double origin, double direction, double half, RaySpan& span) {
  if (std::abs(direction) < kTiny) return std::abs(origin) <= half;
  const double a = (-half - origin) / direction;
  const double b = (half - origin) / direction;
  span.enter = std::max(span.enter, std::min(a, b));
  span.leave = std::min(span.leave, std::max(a, b));
  return span.enter <= span.leave;
}

// The same for |o + s d| <= radius in two or three dimensions.
template <typename V>
bool ClipBall(const V& o, const V& d, double radius, RaySpan& span) {
  const double a = d.squaredNorm();
  const double c = o.squaredNorm() - radius * radius;
  if (a < kTiny * kTiny) return c <= 0;
  const double b = o.dot(d);
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return false;
  const double root = std::sqrt(discriminant);
  span.enter = std::max(span.enter, (-b - root) / a);
  span.leave = std::min(span.leave, (-b + root) / a);
  return span.enter <= span.leave;
}

bool Clip(const Shape& shape, const Vector3d& p, const Vector3d& d, RaySpan& span) {
  const Vector3d half = 0.5 * shape.size;
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      return ClipBall(p, d, half.x(), span);
    case Shape::Kind::kCylinder:
      return ClipBall(Vector2d(p.head<2>()), Vector2d(d.head<2>()), half.x(), span) &&
             ClipSlab(p.z(), d.z(), half.z(), span);
    case Shape::Kind::kBox:
      break;
  }
  return ClipSlab(p.x(), d.x(), half.x(), span) && ClipSlab(p.y(), d.y(), half.y(), span) &&
         ClipSlab(p.z(), d.z(), half.z(), span);
}

}  // namespace

std::optional<RaySpan> RayThrough(const Shape& shape, const Vector3d& p_O, const Vector3d& d_O) {
  RaySpan span{0, std::numeric_limits<double>::infinity()};
  if (!Clip(shape, p_O, d_O, span) || !std::isfinite(span.leave)) return std::nullopt;
  return span;
}

}  // namespace springgrasp
