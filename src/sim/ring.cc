#include "sim/ring.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {

Ring RingForSphere(double diameter) {
  Ring ring;
  ring.radius = 0.30 * diameter;
  ring.tube = 0.06 * diameter;
  return ring;
}

double SphereHeightOnRing(const Ring& ring, double radius) {
  // Every capsule touches at its middle, which is nearest to the ring's axis.
  const double a = ring.radius * std::cos(M_PI / ring.segments);
  const double reach = radius + ring.tube;
  return ring.tube + std::sqrt(std::max(0.0, reach * reach - a * a));
}

}  // namespace springgrasp
