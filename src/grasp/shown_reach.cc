#include "grasp/shown_reach.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "demonstration/half_seen.h"
#include "demonstration/steady_hand.h"
#include "grasp/learn.h"
#include "grasp/learn_complete.h"
#include "grasp/learn_reach.h"

namespace springgrasp {
namespace {

// The speed that noise alone leaves in smoothed positions: what a hand at rest seems to move by.
double SpeedOfNoise(double noise) { return 8 * noise; }  // 1/s: deviation after a 5 Hz low-pass

}  // namespace

ShownReach FindShownReach(const Demonstration& shown, const std::string& type,
                          const PerFinger<bool>& involved) {
  ShownReach reach;
  reach.demonstration = WithSteadyHand(WithoutHalfSeenTips(shown), involved);
  const std::string& source = reach.demonstration.source;
  reach.track = MakeHandTrack(reach.demonstration);
  reach.closing = involved;
  bool any = false;
  for (int i = kIndex; i < kNumFingers; ++i) {
    reach.closing[i] = involved[i] && reach.track.observed[i];
    any = any || reach.closing[i];
  }
  ThrowUnless(any, "{}: no finger of a {} was seen beside the thumb", source, type);
  const HandTrack& track = reach.track;
  reach.segment = FindReach(HandSpeed(track), ThumbFingerSpan(track, reach.closing), track.dt,
                            SpeedOfNoise(track.hand_noise), 0.5 * track.tip_noise);
  const double duration = (reach.segment.contact - reach.segment.begin) * track.dt;
  ThrowUnless(reach.segment.contact - reach.segment.begin >= 10,
              "{}: the movement lasts {:.2f} s, too short to learn from", source, duration);
  // A hand moves no faster than its reach lets it: what is left is the tracker's.
  reach.track = MakeHandTrack(reach.demonstration, kReachBandwidth / duration);
  return reach;
}

std::vector<Fingertips> DemonstratedTips(const Demonstration& shown, const Grasp& grasp,
                                         int steps) {
  ShownReach reach = FindShownReach(shown, grasp.type, grasp.involved);
  HandTrack& track = reach.track;
  ThrowUnless(track.orientation,
              "{}: the hand's orientation was not recorded, so that its fingertips cannot be "
              "played back",
              shown.source);
  CompleteFingers(FindSeenAtEnds(track, reach.segment), reach.closing, reach.segment, {}, track);
  const Fingertips relaxed = DefaultRelaxedTips();
  std::vector<Fingertips> tips;
  for (int n = 0; n < steps; ++n) {
    const double t = grasp.quality.begin - track.t0 +
                     grasp.scales.T * static_cast<double>(n) / std::max(1, steps - 1);
    const int k = std::clamp(static_cast<int>(std::lround(t / track.dt)), reach.segment.begin,
                             reach.segment.contact);
    tips.push_back(track.p_HF[static_cast<std::size_t>(k)]);
    for (int f = 0; f < kNumFingers; ++f) {
      if (!track.observed[f])
        tips.back()[f] = relaxed[f] * (grasp.hand_length / kNominalHandLength);
    }
  }
  return tips;
}

}  // namespace springgrasp
