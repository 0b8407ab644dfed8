#include <algorithm>
#include <cmath>

#include "experiment/observe.h"

namespace springgrasp {
namespace {

// The value below which `fraction` of the values lie; 0 for none.
double Quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(fraction * double(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

// Finger f is reported where another finger is: nearer to that one by half, and far from its own.
bool IsSwapped(const PerFinger<std::optional<Eigen::Vector3d>>& tips, const Eigen::Vector3d& seen,
               int f) {
  constexpr double kFar = 0.015;  // m, nearly a cap's width
  const double own = (seen - *tips[f]).norm();
  for (int g = 0; g < kNumFingers; ++g) {
    if (g != f && own > kFar && (seen - *tips[g]).norm() < own / 2) return true;
  }
  return false;
}

}  // namespace

ObservationErrors CompareToTruth(const Demonstration& tracked, const Demonstration& truth,
                                 const std::vector<PerFinger<double>>& visible) {
  ObservationErrors errors;
  PerFinger<std::vector<double>> distances;
  std::vector<double> all, wrist, turn;
  PerFinger<int> visible_count = {}, visible_seen = {}, seen = {};
  const std::size_t n = std::min(tracked.samples.size(), truth.samples.size());
  for (std::size_t i = 0; i < n; ++i) {
    const DemonstrationSample &a = tracked.samples[i], &b = truth.samples[i];
    for (int f = 0; f < kNumFingers; ++f) {
      const bool counts = visible.empty() || visible[i][f] >= ObservationErrors::kVisible;
      visible_count[f] += counts;
      if (!a.p_WF[f]) continue;
      ++seen[f];
      visible_seen[f] += counts;
      const double distance = (*a.p_WF[f] - *b.p_WF[f]).norm();
      if (counts) {
        distances[f].push_back(distance);
        all.push_back(distance);
      }
      errors.label_swaps += IsSwapped(b.p_WF, *a.p_WF[f], f);
    }
    if (a.p_WH) wrist.push_back((*a.p_WH - *b.p_WH).norm());
    if (a.R_WH) turn.push_back(RotationDistance(*a.R_WH, *b.R_WH) * 180 / M_PI);
  }
  for (int f = 0; f < kNumFingers; ++f) {
    errors.median[f] = Quantile(distances[f], 0.5);
    errors.p95[f] = Quantile(distances[f], 0.95);
    errors.counted[f] = static_cast<int>(distances[f].size());
    errors.coverage[f] = visible_count[f] > 0 ? double(visible_seen[f]) / visible_count[f] : 0;
    errors.seen[f] = n > 0 ? double(seen[f]) / double(n) : 0;
  }
  errors.median_all = Quantile(all, 0.5);
  errors.wrist_median = Quantile(wrist, 0.5);
  errors.wrist_rotation_median_deg = Quantile(turn, 0.5);
  errors.wrist_coverage = n > 0 ? double(wrist.size()) / double(n) : 0;
  errors.rotation_coverage = n > 0 ? double(turn.size()) / double(n) : 0;
  return errors;
}

}  // namespace springgrasp
