// Fingers that were hidden when the hand began to move or closed on the object.
#pragma once

#include <optional>

#include "base/fingers.h"
#include "grasp/grasp.h"
#include "grasp/learn_segment.h"
#include "grasp/learn_track.h"

namespace springgrasp {

// Which fingers were seen within 0.06 s of the reach's begin, and of its contact.
struct SeenAtEnds {
  PerFinger<bool> begin = {}, contact = {};
};
SeenAtEnds FindSeenAtEnds(const HandTrack& track, const ReachSegment& reach);

// Completes p_HF of observed fingers that were hidden at an end of the reach by the minimum-jerk
// movement that fits best what was seen of them: from rest at the begin to the widest opening, and
// from there to rest at the contact; there at `p_HC` where it is given. A finger that was seen too
// little stays where it was.
void CompleteFingers(const SeenAtEnds& seen, const PerFinger<bool>& involved,
                     const ReachSegment& reach,
                     const PerFinger<std::optional<Eigen::Vector3d>>& p_HC, HandTrack& track);

// Contacts in H of involved fingers that were hidden there, m, from the grasp's object and the
// others' contacts: of the thumb the far side of the object from the virtual finger, which it
// opposes; of a finger the surface nearest to where it was going.
PerFinger<std::optional<Eigen::Vector3d>> HiddenContacts(const SeenAtEnds& seen, const Grasp& grasp,
                                                         const PerFinger<Eigen::Vector3d>& p_HC);

}  // namespace springgrasp
