#include "sim/closest_shape.h"

#include <cmath>
#include <numbers>

#include "base/error.h"

namespace springgrasp {
namespace {

constexpr int kDirections = 1000;
constexpr double kThinnest = 0.001;  // m, of a shape in a scene
constexpr double kOffMiddle = 0.05;  // of the object's extent along an axis

// Evenly over the sphere, on a spiral.
std::vector<Eigen::Vector3d> Directions() {
  std::vector<Eigen::Vector3d> directions;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections, r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(turn * i), r * std::sin(turn * i), z);
  }
  return directions;
}

double Width(const std::vector<ObjectPart>& parts, const Eigen::Vector3d& d) {
  return ReachOf(parts, d) + ReachOf(parts, -d);
}

// Extents along O's axes. Throws Error.
Eigen::Vector3d Extents(const std::vector<ObjectPart>& parts) {
  Eigen::Vector3d extents;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d d = Eigen::Vector3d::Unit(axis);
    extents[axis] = Width(parts, d);
    ThrowUnless(extents[axis] >= kThinnest / 2 && extents[axis] <= 1,
                "the object is {:g} m wide along {}, expected 0.0005 to 1 m; lengths are in metres",
                extents[axis], "xyz"[axis]);
    const double off = ReachOf(parts, d) - extents[axis] / 2;
    ThrowUnless(std::abs(off) <= kOffMiddle * extents[axis],
                "the middle of the object is {:.1f} mm off its origin along {}, expected at most "
                "{:.1f} mm: move the origin there, or say what the object shall be taken for",
                1e3 * off, "xyz"[axis], 1e3 * kOffMiddle * extents[axis]);
  }
  return extents;
}

ObjectPart PartOf(const Shape& shape) {
  ObjectPart part;
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      part.kind = ObjectPart::Kind::kSphere;
      part.size[0] = shape.size.x() / 2;
      break;
    case Shape::Kind::kCylinder:
      part.kind = ObjectPart::Kind::kCylinder;
      part.size = Eigen::Vector3d(shape.size.x() / 2, shape.size.z() / 2, 0);
      break;
    case Shape::Kind::kBox:
      part.kind = ObjectPart::Kind::kBox;
      part.size = shape.size / 2;
      break;
  }
  return part;
}

// In tenths of millimetres, as scenes take them.
Shape Rounded(Shape shape) {
  shape.size = ((shape.size * 1e4).array().round() / 1e4).max(kThinnest);
  return shape;
}

}  // namespace

ClosestShape FindClosestShape(const std::vector<ObjectPart>& parts) {
  const Eigen::Vector3d extents = Extents(parts);
  const std::vector<Eigen::Vector3d> directions = Directions();
  double across = 0, about = 0;
  for (const Eigen::Vector3d& d : directions) {
    across += Width(parts, d) / kDirections;
    about += Width(parts, Eigen::Vector3d(d.x(), d.y(), 0).normalized()) / kDirections;
  }
  ClosestShape closest;
  closest.error = 1e300;
  for (const Shape& candidate :
       {Shape{Shape::Kind::kSphere, Eigen::Vector3d::Constant(across)},
        Shape{Shape::Kind::kCylinder, Eigen::Vector3d(about, about, extents.z())},
        Shape{Shape::Kind::kBox, extents}}) {
    const Shape shape = Rounded(candidate);
    const std::vector<ObjectPart> part = {PartOf(shape)};
    double squares = 0;
    for (const Eigen::Vector3d& d : directions) {
      squares += std::pow(ReachOf(part, d) - ReachOf(parts, d), 2);
    }
    const double error = std::sqrt(squares / kDirections);
    if (error < closest.error) closest = {shape, error};
  }
  return closest;
}

}  // namespace springgrasp
