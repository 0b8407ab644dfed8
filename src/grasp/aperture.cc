#include "grasp/aperture.h"

#include <algorithm>

namespace springgrasp {

using Eigen::Vector3d;

double Aperture(const PerFinger<Vector3d>& p_H, const PerFinger<bool>& involved) {
  Vector3d mean = Vector3d::Zero();
  int count = 0;
  for (int i = kIndex; i < kNumFingers; ++i) {
    if (!involved[i]) continue;
    mean += p_H[i];
    ++count;
  }
  return (mean / std::max(1, count) - p_H[kThumb]).norm();
}

double WidestStep(const std::vector<PerFinger<Vector3d>>& p_H, const PerFinger<bool>& involved,
                  std::size_t widest) {
  const double least = Aperture(p_H[widest], involved) - 0.001;
  std::size_t from = widest, to = widest;
  while (from > 0 && Aperture(p_H[from - 1], involved) >= least) --from;
  while (to + 1 < p_H.size() && Aperture(p_H[to + 1], involved) >= least) ++to;
  return 0.5 * static_cast<double>(from + to);
}

WidestAperture FindWidestAperture(const FingertipMotion& motion) {
  WidestAperture out;
  out.start = Aperture(motion.samples.front().p_HF, motion.involved);
  for (const FingertipMotionSample& sample : motion.samples) {
    const double aperture = Aperture(sample.p_HF, motion.involved);
    if (aperture <= out.widest) continue;
    out.widest = aperture;
    out.at = sample.t / motion.T;
  }
  return out;
}

double ContactError(const FingertipMotion& motion, double from, double to) {
  double error = 0;
  for (const FingertipMotionSample& sample : motion.samples) {
    if (sample.t < from - 1e-9 || sample.t > to + 1e-9) continue;
    for (int i = 0; i < kNumFingers; ++i) {
      if (!motion.involved[i]) continue;
      error = std::max(error, (sample.p_HF[i] - motion.X_HO * motion.p_OC[i]).norm());
    }
  }
  return error;
}

}  // namespace springgrasp
