// A hand pose that agrees with the fingertips seen from it.
#pragma once

#include "base/fingers.h"
#include "demonstration/demonstration.h"

namespace springgrasp {

// The same demonstration with the hand pose that is most likely given how it was seen and how
// fingers move in a hand: those of the grasp (`involved`) at 0.2 m/s or so, the others hardly, and
// none of them while its tip rests in the world. A batch least-squares fit of a slow correction of
// the seen poses, at all samples between the first and the last that have one.
//
// A tracked hand pose is by far the least certain part of a demonstration; its error wanders by
// some mm and degrees within a reach, also while the hand rests, and seen from such a hand fingers
// move that do not. How far the pose is trusted follows the noise of the tips: that of a motion
// capture system stays what it is. Without orientation, or without noise, nothing changes.
Demonstration WithSteadyHand(const Demonstration& demonstration, const PerFinger<bool>& involved);

}  // namespace springgrasp
