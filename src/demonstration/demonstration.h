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
  double t = 0;                                         // s
  std::optional<Eigen::Vector3d> p_WH;                  // wrist centre, m
  std::optional<Eigen::Quaterniond> R_WH;               // hand frame H, unit
  PerFinger<std::optional<Eigen::Vector3d>> p_WF;       // fingertip (pad sphere) centres, m
  PerFinger<double> confidence = {};                    // tracker's, 0..1; 0 when not seen
};

struct DemonstratedObject {
  Shape shape;
  Pose X_WO = Pose::Identity();
};

// A whole movement, in time order. `frame` names what W stands for.
struct Demonstration {
  std::string source;                                   // file or scene, for messages
  std::string frame = "world";                          // world | root | camera_left | recording
  std::optional<Eigen::Vector3d> up = Eigen::Vector3d::UnitZ();
  std::optional<DemonstratedObject> object;
  double marker_offset = 0;                             // m, marker centre to fingertip
  std::vector<std::string> comments;                    // other `#` lines, kept
  std::vector<DemonstrationSample> samples;
};

// Reads and writes the demonstration CSV (README, "Files"). Reading throws Error with file and
// line for a text cell, a non-finite value, time not increasing, fewer than kMinSamples samples,
// or fewer than two fingers; further columns are ignored.
inline constexpr int kMinSamples = 8;
Demonstration ReadDemonstration(const std::string& path);
Demonstration ParseDemonstration(const std::string& text, const std::string& name);
std::string FormatDemonstration(const Demonstration& demonstration);
void WriteDemonstration(const Demonstration& demonstration, const std::string& path);

}  // namespace springgrasp
