// DEMONSTRATION: what was seen (or recorded) of a human grasp. Hand pose and fingertips over time.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"

namespace springgrasp {

// One instant. What was not seen is absent, never invented.
struct DemonstrationSample {
  double t = 0;                                    // s
  std::optional<Eigen::Vector3d> p_WH;             // wrist centre, m
  std::optional<Eigen::Quaterniond> R_WH;          // hand frame H, unit
  PerFinger<std::optional<Eigen::Vector3d>> p_WF;  // fingertip (pad sphere) centres, m
  PerFinger<double> confidence = {};               // tracker's, 0..1; 0 when not seen
  std::vector<std::string> further;                // cells of Demonstration::further_columns
};

struct DemonstratedObject {
  Shape shape;
  Pose X_WO = Pose::Identity();
};

// A whole movement, in time order. `frame` names what W stands for.
struct Demonstration {
  std::string source;           // file or scene, for messages
  std::string frame = "world";  // world | root | camera_left | recording
  std::optional<Eigen::Vector3d> up = Eigen::Vector3d::UnitZ();
  std::optional<DemonstratedObject> object;
  double marker_offset = 0;                  // m, marker centre to fingertip
  std::vector<std::string> comments;         // other `#` lines, kept
  std::vector<std::string> further_columns;  // names of columns that mean nothing to us
  std::vector<DemonstrationSample> samples;
};

// Reads and writes the demonstration CSV (README, "Files"). Columns may come in any order and a
// whole finger, the wrist or its orientation may be absent; further columns are kept and ignored.
// A column `<finger>_confidence` fills `confidence` (1 for a seen fingertip without one). Reading
// throws Error with file and line for a text cell, a non-finite value, half a point, a quaternion
// that is not unit, time not increasing, a rate outside 15 to 1000 Hz, fewer than kMinSamples
// samples, or fewer than two fingers. A `frame:` comment of several words (a description) means
// `recording`.
inline constexpr int kMinSamples = 8;
Demonstration ReadDemonstration(const std::string& path);
Demonstration ParseDemonstration(const std::string& text, const std::string& name);
std::string FormatDemonstration(const Demonstration& demonstration);
void WriteDemonstration(const Demonstration& demonstration, const std::string& path);

// A finger counts as recorded when it was seen in at least kMinSamples samples.
PerFinger<bool> RecordedFingers(const Demonstration& demonstration);

}  // namespace springgrasp
