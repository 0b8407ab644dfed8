#include "experiment/arm_reference.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

template <typename Vector, typename Reference>
void Interpolate(const std::vector<Vector>& path, double dt, double t, Reference& reference) {
  const double s = std::clamp(t / dt, 0.0, static_cast<double>(path.size() - 1));
  const long i = static_cast<long>(s);
  const double u = s - static_cast<double>(i);
  const auto at = [&](long k) -> const Vector& {
    return path[static_cast<std::size_t>(
        std::clamp<long>(k, 0, static_cast<long>(path.size()) - 1))];
  };
  const auto velocity = [&](long k) -> Vector { return (at(k + 1) - at(k - 1)) / (2 * dt); };
  const auto acceleration = [&](long k) -> Vector {
    return (at(k + 1) - 2 * at(k) + at(k - 1)) / (dt * dt);
  };
  reference.q = (1 - u) * at(i) + u * at(i + 1);
  reference.qd = (1 - u) * velocity(i) + u * velocity(i + 1);
  reference.qdd = (1 - u) * acceleration(i) + u * acceleration(i + 1);
  if (t >= dt * static_cast<double>(path.size() - 1)) {
    reference.qd.setZero();
    reference.qdd.setZero();
  }
}

}  // namespace

ArmTarget ArmReferenceAt(const std::vector<ArmVector>& path, double dt, double t) {
  ArmTarget target;
  Interpolate(path, dt, t, target);
  return target;
}

HandReference HandReferenceAt(const std::vector<HandVector>& path, double dt, double t) {
  HandReference reference;
  Interpolate(path, dt, t, reference);
  return reference;
}

}  // namespace springgrasp
