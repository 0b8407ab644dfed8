// The reach within a demonstration: a steady hand, its fingertips, and where the movement lies.
#pragma once

#include <string>
#include <vector>

#include "base/fingers.h"
#include "demonstration/demonstration.h"
#include "grasp/grasp.h"
#include "grasp/learn_segment.h"
#include "grasp/learn_track.h"

namespace springgrasp {

struct ShownReach {
  Demonstration demonstration;  // half-seen tips left out, the hand steadied
  HandTrack track;              // no faster than a reach of this duration lets a hand be
  ReachSegment segment;
  PerFinger<bool> closing = {};  // involved fingers that were seen, and the thumb
};

// Throws Error (one line) if no involved finger was seen beside the thumb, or the movement is too
// short to learn from.
ShownReach FindShownReach(const Demonstration& shown, const std::string& type,
                          const PerFinger<bool>& involved);

// The demonstrated fingertips in H, m, as they were: smoothed, gaps bridged, in `steps` even steps
// over the reach that `grasp` was learned from, at its end for ever. A finger that was never seen
// lies as in the relaxed hand. Throws Error if the hand's orientation was not recorded.
std::vector<Fingertips> DemonstratedTips(const Demonstration& shown, const Grasp& grasp, int steps);

}  // namespace springgrasp
