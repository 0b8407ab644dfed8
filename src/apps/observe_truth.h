// How far a tracked recording is from its truth.
#pragma once

#include <string>

#include "demonstration/demonstration.h"

namespace springgrasp {

// Truth of a recording: a CSV with a header line; t and <finger>_x, _y, _z (centre of each cap, m,
// in the left camera's frame) of all five fingers in each row, optionally
// <finger>_visible_left and _right (0..1). Throws Error with file and line.
struct RecordedTruth {
  Demonstration shown;
  std::vector<PerFinger<double>> visible;  // the smaller of both views; empty if not told
};
RecordedTruth ReadRecordedTruth(const std::string& path);

// Prints errors of the fingertips while visible, and label swaps. A tracked sample belongs to the
// nearest row of the truth within half of `frame_time` (s). Throws Error if none does.
void PrintErrors(const Demonstration& tracked, const Pose& X_WL, const RecordedTruth& truth,
                 double frame_time);

}  // namespace springgrasp
