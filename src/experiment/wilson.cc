#include "experiment/wilson.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {

RateInterval WilsonInterval(int successes, int n) {
  if (n <= 0) return {};
  constexpr double z = 1.959963984540054;
  const double p = double(successes) / n;
  const double denominator = 1 + z * z / n;
  const double centre = (p + z * z / (2.0 * n)) / denominator;
  const double half = z / denominator * std::sqrt(p * (1 - p) / n + z * z / (4.0 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

}  // namespace springgrasp
