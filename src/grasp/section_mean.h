// Mean radius of a section, from how far the surface is in every direction.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace springgrasp {

// Mean of `distance(direction)`, m, over unit directions orthogonal to `normal` (any length; zero
// stands for z).
template <typename Distance>
double MeanOverSection(const Eigen::Vector3d& normal, Distance&& distance) {
  constexpr double kTiny = 1e-12;
  constexpr int kDirections = 720;
  const Eigen::Vector3d n =
      normal.norm() > kTiny ? Eigen::Vector3d(normal.normalized()) : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d u = n.unitOrthogonal();
  const Eigen::Vector3d v = n.cross(u);
  double sum = 0;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / kDirections;
    sum += distance(Eigen::Vector3d(std::cos(angle) * u + std::sin(angle) * v));
  }
  return sum / kDirections;
}

}  // namespace springgrasp
