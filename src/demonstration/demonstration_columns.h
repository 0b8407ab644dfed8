// Columns of the demonstration CSV, shared by reading and writing.
#pragma once

#include <string>
#include <vector>

#include "base/fingers.h"

namespace springgrasp {

// Of one sample in file order; the wrist's seven come first, then three per finger.
inline constexpr int kWristColumns = 7;
inline constexpr int kPointColumns = kWristColumns + 3 * kNumFingers;

// wrist_x ... pinkie_z, kPointColumns names.
std::vector<std::string> PointColumnNames();

}  // namespace springgrasp
