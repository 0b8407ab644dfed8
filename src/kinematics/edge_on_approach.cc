#include <algorithm>
#include <cmath>

#include "kinematics/hand_motion.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {

std::vector<Pose> EdgeOnApproach(const std::vector<Pose>& X_OH, const Pose& X_HG,
                                 const Eigen::Vector3d& n_O, double dt, double T) {
  constexpr double kLevel = 0.65;                // of T, then the hand is level with the plate
  constexpr double kAside = 0.008, kRise = 0.8;  // m, of T: and this much aside until then
  const int n = static_cast<int>(X_OH.size());
  if (n == 0) return {};
  const int last = std::min(n - 1, static_cast<int>(std::lround(T / dt)));
  const Pose X_GH = X_HG.inverse();
  std::vector<Pose> path;
  for (int k = 0; k < n; ++k) {
    const double s = dt * k / T;
    const int early = std::min(std::max(k, last), static_cast<int>(std::lround(k / kLevel)));
    const Pose X_OG = X_OH[k] * X_HG, X_OG_early = X_OH[std::min(early, n - 1)] * X_HG;
    const double aside =
        kAside * MinimumJerkPosition(s / kLevel) * MinimumJerkPosition((1 - s) / (1 - kRise));
    Pose X = X_OG_early;
    X.translation() =
        X_OG.translation() + n_O * (n_O.dot(X_OG_early.translation() - X_OG.translation()) - aside);
    path.push_back(X * X_GH);
  }
  return path;
}

}  // namespace springgrasp
