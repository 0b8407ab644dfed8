// Fingertips at the edge of what hides them.
#pragma once

#include "demonstration/demonstration.h"

namespace springgrasp {

// The same demonstration without the last place of a fingertip before it was hidden for 0.08 s or
// longer, and the first one after: there a marker is seen in part, and its middle is not where that
// of the part is (a tracker's error is three to five times its usual one). A finger that was seen
// in fewer than three samples in a row is left alone.
Demonstration WithoutHalfSeenTips(const Demonstration& demonstration);

}  // namespace springgrasp
