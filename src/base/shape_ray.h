// Where a straight line meets a shape.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/shape.h"

namespace springgrasp {

// Lengths along a ray, m: it is inside the shape between them. A ray that begins inside enters at
// 0.
struct RaySpan {
  double enter = 0, leave = 0;
};
// The ray p + s d, s >= 0 (d unit, both in O); nothing if it misses the shape.
std::optional<RaySpan> RayThrough(const Shape& shape, const Eigen::Vector3d& p_O,
                                  const Eigen::Vector3d& d_O);

}  // namespace springgrasp
