// Dimensionless gains of the spring model (spring-model note, section 5): what stays the same when
// a grasp is made faster, farther, or on another object. lengths ~ x0, times ~ T.
#pragma once

#include <vector>

namespace springgrasp {

// The scales of one movement.
struct ReachScales {
  double T = 1;      // duration of the reach, s
  double A = 0.3;    // length of the reach (chord of H's origin), m
  double x0 = 0.05;  // mean distance of the involved tips from their contacts at the start, m
};

struct DimensionlessGains {
  double reach = 50;              // gamma A / (m x0)
  double omega_T = 10;            // T sqrt(kc / m)
  double zeta = 1.5;              // dc / (2 sqrt(kc m))
  std::vector<double> stiffness;  // k_e / kc, per edge
  std::vector<double> damping;    // d_e / dc, per edge
  double delay = 0;               // delay of f_cen / T
  double closing = 1;             // beta, multiplies f_cen > 0
  double holding = 0.5;           // f_cen after T / (kc x0)
};

// The same in SI units.
struct SpringGains {
  double gamma = 0;          // reach acceleration to central force, kg
  double mass = 0.02;        // of every fingertip, kg
  double kc = 1, dc = 0.3;   // contact stiffness N/m and damping N s/m
  std::vector<double> k, d;  // per edge, N/m and N s/m
  double delay = 0;          // s
  double closing = 1;
  double holding = 0;  // N
};

DimensionlessGains MakeDimensionless(const SpringGains& gains, const ReachScales& scales);
SpringGains RestoreGains(const DimensionlessGains& gains, double mass, const ReachScales& scales);

}  // namespace springgrasp
