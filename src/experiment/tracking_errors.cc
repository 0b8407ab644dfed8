#include "experiment/tracking_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/pose.h"

namespace springgrasp {
namespace {

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

bool IsRight(const TrackingFrame& frame, int finger) {
  return frame.error[finger] && *frame.error[finger] < Recovery::kRight && !frame.swapped[finger];
}

// A cap that is seen again at frame `begin`.
void Recover(const std::vector<TrackingFrame>& frames, int finger, std::size_t begin,
             Recovery& recovery) {
  std::size_t i = begin;
  while (i < frames.size() && frames[i].IsVisible(finger) && !IsRight(frames[i], finger)) ++i;
  const bool right = i < frames.size() && frames[i].IsVisible(finger);
  const auto passed = static_cast<int>(i - begin);
  if (!right && passed < Recovery::kSoon) return;
  ++recovery.hidden;
  recovery.soon += right && passed <= Recovery::kSoon;
  recovery.worst = std::max(recovery.worst, passed);
}

std::string Cell(const std::optional<double>& value) {
  return value ? fmt::format("{:.6f}", *value) : std::string();
}

}  // namespace

double Quantile(std::vector<double> values, double fraction) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(fraction * double(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

std::vector<TrackingFrame> CompareFrames(const Demonstration& tracked, const Demonstration& truth,
                                         const std::vector<PerFinger<double>>& visible) {
  std::vector<TrackingFrame> frames;
  const std::size_t n = std::min(tracked.samples.size(), truth.samples.size());
  for (std::size_t i = 0; i < n; ++i) {
    const DemonstrationSample &a = tracked.samples[i], &b = truth.samples[i];
    TrackingFrame frame;
    frame.t = b.t;
    frame.visible.fill(1);
    if (!visible.empty()) frame.visible = visible[i];
    for (int f = 0; f < kNumFingers; ++f) {
      if (!a.p_WF[f]) continue;
      frame.error[f] = (*a.p_WF[f] - *b.p_WF[f]).norm();
      frame.swapped[f] = IsSwapped(b.p_WF, *a.p_WF[f], f);
    }
    if (a.p_WH) frame.wrist = (*a.p_WH - *b.p_WH).norm();
    if (a.R_WH) frame.rotation = RotationDistance(*a.R_WH, *b.R_WH);
    frames.push_back(frame);
  }
  return frames;
}

Recovery CountRecoveries(const std::vector<TrackingFrame>& frames) {
  Recovery recovery;
  for (int f = 0; f < kNumFingers; ++f) {
    int hidden = -1;  // frames since the cap was last seen; negative: never seen yet
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (!frames[i].IsVisible(f)) {
        hidden += hidden >= 0;
        continue;
      }
      if (hidden > 0 && hidden <= Recovery::kLongest) Recover(frames, f, i, recovery);
      hidden = 0;
    }
  }
  return recovery;
}

std::string FormatTracking(const std::vector<TrackingFrame>& frames) {
  std::string text = "t";
  for (const auto finger : kFingerNames) text += fmt::format(",{}_m", finger);
  for (const auto finger : kFingerNames) text += fmt::format(",{}_visible", finger);
  text += ",wrist_m,rotation_rad,swapped\n";
  for (const TrackingFrame& frame : frames) {
    text += fmt::format("{:.6f}", frame.t);
    for (const auto& error : frame.error) text.append(",").append(Cell(error));
    for (const double visible : frame.visible) text += fmt::format(",{:.3f}", visible);
    text += fmt::format(",{},{},", Cell(frame.wrist), Cell(frame.rotation));
    std::vector<std::string_view> names;
    for (int f = 0; f < kNumFingers; ++f) {
      if (frame.swapped[f]) names.push_back(kFingerNames[f]);
    }
    text += fmt::format("{}\n", fmt::join(names, " "));
  }
  return text;
}

}  // namespace springgrasp
