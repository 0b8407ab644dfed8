// Object shapes that the chain knows exactly: what perception is assumed to have told.
#pragma once

#include <Eigen/Core>
#include <string>

namespace springgrasp {

// A convex primitive centred at the origin of the object frame O, upright along z.
struct Shape {
  enum class Kind { kSphere, kCylinder, kBox };
  Kind kind = Kind::kSphere;
  // Full extents along O's axes, m. Sphere: all three the diameter; cylinder: x = y = diameter,
  // z = height.
  Eigen::Vector3d size = Eigen::Vector3d::Constant(0.04);
};

// Reads `sphere:D`, `cylinder:DxH` or `box:XxYxZ` (full extents, metres). Throws Error.
Shape ParseShape(const std::string& text);
// The reverse of ParseShape, shortest digits that read back equal.
std::string FormatShape(const Shape& shape);

}  // namespace springgrasp
