// How far the tracker was off, frame by frame and over a sequence.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/fingers.h"
#include "demonstration/demonstration.h"

namespace springgrasp {

// A cap counts as visible where both eyes see this much of it.
inline constexpr double kVisible = 0.3;

struct TrackingFrame {
  double t = 0;                            // s
  PerFinger<std::optional<double>> error;  // m, of the fingertip; absent: not tracked
  PerFinger<double> visible = {};          // the smaller of both eyes' fractions, 0..1
  PerFinger<bool> swapped = {};            // reported where another fingertip is
  std::optional<double> wrist;             // m
  std::optional<double> rotation;          // rad
  bool IsVisible(int finger) const { return visible[finger] >= kVisible; }
};

// Instant by instant; `visible` per instant of `truth`, empty: all is.
std::vector<TrackingFrame> CompareFrames(const Demonstration& tracked, const Demonstration& truth,
                                         const std::vector<PerFinger<double>>& visible);

// What became of caps that were hidden for 1 to 15 frames and then seen again. A cap is right when
// it is tracked to within 8 mm. Those that vanish again, or whose sequence ends, before five
// frames are over count only if they were right by then.
struct Recovery {
  static constexpr int kLongest = 15, kSoon = 5;  // frames
  static constexpr double kRight = 0.008;         // m
  int hidden = 0;                                 // that count
  int soon = 0;                                   // right within five frames
  int worst = 0;  // frames until right, of the slowest; the sequence's rest if never
};
Recovery CountRecoveries(const std::vector<TrackingFrame>& frames);

// One row per frame: t, <finger>_m (empty: not tracked), <finger>_visible, wrist_m, rotation_rad,
// swapped (names, blanks between).
std::string FormatTracking(const std::vector<TrackingFrame>& frames);

// The value below which `fraction` of the values lie; 0 for none.
double Quantile(std::vector<double> values, double fraction);

}  // namespace springgrasp
