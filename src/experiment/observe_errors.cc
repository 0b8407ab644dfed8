#include <algorithm>
#include <cmath>

#include "experiment/observe.h"

namespace springgrasp {

ObservationErrors SummariseFrames(const std::vector<TrackingFrame>& frames) {
  ObservationErrors errors;
  PerFinger<std::vector<double>> distances;
  std::vector<double> all, wrist, turn;
  PerFinger<int> visible_count = {}, visible_seen = {}, seen = {};
  for (const TrackingFrame& frame : frames) {
    int swapped = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      const bool counts = frame.IsVisible(f);
      visible_count[f] += counts;
      swapped += frame.swapped[f];
      if (!frame.error[f]) continue;
      ++seen[f];
      visible_seen[f] += counts;
      if (!counts) continue;
      distances[f].push_back(*frame.error[f]);
      all.push_back(*frame.error[f]);
    }
    errors.label_swaps += swapped;
    errors.swap_frames += swapped > 0;
    if (frame.wrist) wrist.push_back(*frame.wrist);
    if (frame.rotation) turn.push_back(*frame.rotation * 180 / M_PI);
  }
  const auto n = static_cast<double>(frames.size());
  int all_visible = 0, all_seen = 0;
  for (int f = 0; f < kNumFingers; ++f) {
    errors.median[f] = Quantile(distances[f], 0.5);
    errors.p95[f] = Quantile(distances[f], 0.95);
    errors.counted[f] = static_cast<int>(distances[f].size());
    errors.coverage[f] = visible_count[f] > 0 ? double(visible_seen[f]) / visible_count[f] : 0;
    errors.seen[f] = n > 0 ? seen[f] / n : 0;
    all_visible += visible_count[f];
    all_seen += visible_seen[f];
  }
  errors.coverage_all = all_visible > 0 ? double(all_seen) / all_visible : 0;
  errors.median_all = Quantile(all, 0.5);
  errors.p95_all = Quantile(all, 0.95);
  errors.wrist_median = Quantile(wrist, 0.5);
  errors.wrist_p95 = Quantile(wrist, 0.95);
  errors.wrist_rotation_median_deg = Quantile(turn, 0.5);
  errors.wrist_rotation_p95_deg = Quantile(turn, 0.95);
  errors.wrist_coverage = n > 0 ? double(wrist.size()) / n : 0;
  errors.rotation_coverage = n > 0 ? double(turn.size()) / n : 0;
  return errors;
}

ObservationErrors CompareToTruth(const Demonstration& tracked, const Demonstration& truth,
                                 const std::vector<PerFinger<double>>& visible) {
  return SummariseFrames(CompareFrames(tracked, truth, visible));
}

}  // namespace springgrasp
