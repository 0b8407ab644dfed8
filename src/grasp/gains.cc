#include "grasp/gains.h"

#include <cmath>

namespace springgrasp {

DimensionlessGains MakeDimensionless(const SpringGains& gains, const ReachScales& scales) {
  DimensionlessGains out;
  out.reach = gains.gamma * scales.A / (gains.mass * scales.x0);
  out.omega_T = scales.T * std::sqrt(gains.kc / gains.mass);
  out.zeta = gains.dc / (2 * std::sqrt(gains.kc * gains.mass));
  for (const double k : gains.k) out.stiffness.push_back(k / gains.kc);
  for (const double d : gains.d) out.damping.push_back(d / gains.dc);
  out.delay = gains.delay / scales.T;
  out.closing = gains.closing;
  out.holding = gains.holding / (gains.kc * scales.x0);
  return out;
}

SpringGains RestoreGains(const DimensionlessGains& gains, double mass, const ReachScales& scales) {
  SpringGains out;
  out.mass = mass;
  const double omega = gains.omega_T / scales.T;
  out.kc = mass * omega * omega;
  out.dc = 2 * gains.zeta * mass * omega;
  for (const double k : gains.stiffness) out.k.push_back(k * out.kc);
  for (const double d : gains.damping) out.d.push_back(d * out.dc);
  out.gamma = gains.reach * mass * scales.x0 / scales.A;
  out.delay = gains.delay * scales.T;
  out.closing = gains.closing;
  out.holding = gains.holding * out.kc * scales.x0;
  return out;
}

}  // namespace springgrasp
