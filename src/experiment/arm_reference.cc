#include "experiment/arm_reference.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

const ArmVector& Clamped(const std::vector<ArmVector>& path, long i) {
  return path[static_cast<std::size_t>(std::clamp<long>(i, 0, static_cast<long>(path.size()) - 1))];
}

}  // namespace

ArmTarget ArmReferenceAt(const std::vector<ArmVector>& path, double dt, double t) {
  const double s = std::clamp(t / dt, 0.0, static_cast<double>(path.size() - 1));
  const long i = static_cast<long>(s);
  const double u = s - static_cast<double>(i);
  const auto velocity = [&](long k) -> ArmVector {
    return (Clamped(path, k + 1) - Clamped(path, k - 1)) / (2 * dt);
  };
  const auto acceleration = [&](long k) -> ArmVector {
    return (Clamped(path, k + 1) - 2 * Clamped(path, k) + Clamped(path, k - 1)) / (dt * dt);
  };
  ArmTarget target;
  target.q = (1 - u) * Clamped(path, i) + u * Clamped(path, i + 1);
  target.qd = (1 - u) * velocity(i) + u * velocity(i + 1);
  target.qdd = (1 - u) * acceleration(i) + u * acceleration(i + 1);
  return target;
}

HandVector HandReferenceAt(const std::vector<HandVector>& path, double dt, double t) {
  const double s = std::clamp(t / dt, 0.0, static_cast<double>(path.size() - 1));
  const std::size_t i = static_cast<std::size_t>(s);
  const std::size_t j = std::min(i + 1, path.size() - 1);
  const double u = s - static_cast<double>(i);
  return (1 - u) * path[i] + u * path[j];
}

}  // namespace springgrasp
