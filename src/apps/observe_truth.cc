#include "apps/observe_truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/error.h"
#include "experiment/observe.h"
#include "experiment/table.h"
#include "experiment/tracking_errors.h"

namespace springgrasp {
namespace {

// Column of `name` among the further ones, -1 if absent.
int FurtherColumn(const Demonstration& demonstration, const std::string& name) {
  const auto& names = demonstration.further_columns;
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace

RecordedTruth ReadRecordedTruth(const std::string& path) {
  RecordedTruth truth{ReadDemonstration(path), {}};
  for (const DemonstrationSample& sample : truth.shown.samples) {
    for (int f = 0; f < kNumFingers; ++f) {
      ThrowUnless(sample.p_WF[f].has_value(), "{}: {} is missing at t = {}, expected all fingers",
                  path, kFingerNames[f], sample.t);
    }
  }
  PerFinger<std::array<int, 2>> columns;
  for (int f = 0; f < kNumFingers; ++f) {
    columns[f] = {FurtherColumn(truth.shown, fmt::format("{}_visible_left", kFingerNames[f])),
                  FurtherColumn(truth.shown, fmt::format("{}_visible_right", kFingerNames[f]))};
    if (columns[f][0] < 0 || columns[f][1] < 0) return truth;
  }
  for (const DemonstrationSample& sample : truth.shown.samples) {
    PerFinger<double>& visible = truth.visible.emplace_back();
    for (int f = 0; f < kNumFingers; ++f) {
      visible[f] = std::min(std::strtod(sample.further[columns[f][0]].c_str(), nullptr),
                            std::strtod(sample.further[columns[f][1]].c_str(), nullptr));
    }
  }
  return truth;
}

void PrintErrors(const Demonstration& tracked, const Pose& X_WL, const RecordedTruth& truth,
                 double frame_time) {
  // Both on the instants that they share.
  Demonstration seen, shown;
  std::vector<PerFinger<double>> visible;
  std::size_t next = 0;
  const auto& rows = truth.shown.samples;
  for (const DemonstrationSample& sample : tracked.samples) {
    while (next + 1 < rows.size() &&
           std::abs(rows[next + 1].t - sample.t) <= std::abs(rows[next].t - sample.t)) {
      ++next;
    }
    if (std::abs(rows[next].t - sample.t) > 0.5 * frame_time) continue;
    seen.samples.push_back(sample);
    DemonstrationSample& row = shown.samples.emplace_back(rows[next]);
    for (auto& p : row.p_WF) p = X_WL * *p;
    if (!truth.visible.empty()) visible.push_back(truth.visible[next]);
  }
  ThrowUnless(!seen.samples.empty(), "{}: tells of no instant of the video", truth.shown.source);
  // The truth's wrist follows another definition than H: only fingertips are compared.
  for (DemonstrationSample& sample : seen.samples) sample.p_WH.reset(), sample.R_WH.reset();
  const ObservationErrors errors = CompareToTruth(seen, shown, visible);
  std::vector<double> all;
  for (std::size_t i = 0; i < seen.samples.size(); ++i) {
    for (int f = 0; f < kNumFingers; ++f) {
      const auto& p = seen.samples[i].p_WF[f];
      const bool counts = visible.empty() || visible[i][f] >= kVisible;
      if (p && counts) all.push_back((*p - *shown.samples[i].p_WF[f]).norm());
    }
  }
  std::vector<std::vector<std::string>> table = {
      {"finger", "median mm", "95 % mm", "tracked while visible %"}};
  for (int f = 0; f < kNumFingers; ++f) {
    table.push_back({std::string(kFingerNames[f]), fmt::format("{:.2f}", 1e3 * errors.median[f]),
                     fmt::format("{:.2f}", 1e3 * errors.p95[f]),
                     fmt::format("{:.1f}", 100 * errors.coverage[f])});
  }
  fmt::print("{}", AlignColumns(table));
  fmt::print("all: median {:.2f} mm, 95 % {:.2f} mm, {} label swaps in {} frames\n",
             1e3 * Quantile(all, 0.5), 1e3 * Quantile(all, 0.95), errors.label_swaps,
             seen.samples.size());
}

}  // namespace springgrasp
