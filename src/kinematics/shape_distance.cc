#include "kinematics/shape_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace springgrasp {
namespace {

constexpr double kSampleStep = 0.006;  // m, along a capsule's axis

double BoxLike(const Eigen::Vector2d& excess, Eigen::Vector2d* direction) {
  // Two half-space excesses whose directions are orthogonal: rounded outside, nearest face inside.
  if (excess.x() > 0 && excess.y() > 0) {
    const double d = excess.norm();
    if (direction != nullptr) *direction = excess / d;
    return d;
  }
  const bool first = excess.x() > excess.y();
  if (direction != nullptr) *direction = first ? Eigen::Vector2d(1, 0) : Eigen::Vector2d(0, 1);
  return first ? excess.x() : excess.y();
}

}  // namespace

double SignedDistance(const Shape& shape, const Eigen::Vector3d& p, Eigen::Vector3d* gradient) {
  switch (shape.kind) {
    case Shape::Kind::kSphere: {
      const double r = p.norm();
      if (gradient != nullptr) {
        *gradient = r > 1e-12 ? Eigen::Vector3d(p / r) : Eigen::Vector3d::UnitX();
      }
      return r - shape.size.x() / 2;
    }
    case Shape::Kind::kCylinder: {
      const double r = p.head<2>().norm();
      Eigen::Vector2d direction;
      const double d = BoxLike({r - shape.size.x() / 2, std::abs(p.z()) - shape.size.z() / 2},
                               gradient != nullptr ? &direction : nullptr);
      if (gradient != nullptr) {
        const Eigen::Vector2d radial =
            r > 1e-12 ? Eigen::Vector2d(p.head<2>() / r) : Eigen::Vector2d::UnitX();
        *gradient << radial * direction.x(), std::copysign(direction.y(), p.z());
      }
      return d;
    }
    case Shape::Kind::kBox:
      break;
  }
  const Eigen::Vector3d excess = p.cwiseAbs() - shape.size / 2;
  const Eigen::Vector3d outside = excess.cwiseMax(0.0);
  const double distance = outside.norm();
  if (distance > 0) {
    if (gradient != nullptr) {
      for (int i = 0; i < 3; ++i) (*gradient)[i] = std::copysign(outside[i] / distance, p[i]);
    }
    return distance;
  }
  int axis = 0;
  const double inside = excess.maxCoeff(&axis);
  if (gradient != nullptr) {
    gradient->setZero();
    (*gradient)[axis] = std::copysign(1.0, p[axis]);
  }
  return inside;
}

double CapsuleDistance(const Shape& shape, const Eigen::Vector3d& p_OA, const Eigen::Vector3d& p_OB,
                       double radius) {
  const int steps = std::max(1, static_cast<int>(std::ceil((p_OB - p_OA).norm() / kSampleStep)));
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    smallest = std::min(smallest, SignedDistance(shape, p_OA + s * (p_OB - p_OA)));
  }
  return smallest - radius;
}

double HandDistance(const RobotHand& hand, const std::vector<Pose>& X_HB, const Pose& X_OH,
                    const Shape& shape, const PerFinger<bool>& fingers, bool palm) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const LinkCapsule& c : hand.capsules) {
    if (c.finger < 0 ? !palm : !fingers[c.finger]) continue;
    const Pose X_OB = X_OH * X_HB[c.node];
    smallest = std::min(smallest, CapsuleDistance(shape, X_OB * c.a, X_OB * c.b, c.radius));
  }
  return smallest;
}

}  // namespace springgrasp
