// A human-like grasp out of what is known of human reaches, where no recording is at hand.
#pragma once

#include <string>

#include "base/random.h"
#include "base/shape.h"
#include "demonstration/hand_motion.h"
#include "experiment/demonstrator_hand.h"

namespace springgrasp {

struct SynthesiseOptions {
  std::string type = "pinch";      // pinch | tripod | power | lateral
  Shape shape;                     // of the object
  std::string approach = "usual";  // usual | side | above, see GraspStyle
  double rate = 100;               // Hz
  double hold = 0.3;               // s at rest after the closing
};

// The motion in the object's frame (X_WO = identity, z up, camera side -y): minimum-jerk wrist on a
// curved path, 0.25-0.35 m in 1.0-1.4 s; thumb-index aperture from a relaxed hand to 51 mm + 0.67 x
// object size at 60-75 % of the reach (Ansuini et al. 2015, mocapGrip), closing on the object when
// the wrist arrives. Draws: duration, distance, peak time, aperture, contact height, tilt,
// direction and curvature, always the same number. Throws Error if no posture holds the object.
HandMotion SynthesiseGrasp(const DemonstratorHand& hand, const SynthesiseOptions& options,
                           RandomEngine& engine);

}  // namespace springgrasp
