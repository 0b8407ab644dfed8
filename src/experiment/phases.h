// The phases of a trial and what they ask for (system contract, section 6). Every number is an
// experiment parameter with the contract's value as its default.
#pragma once

#include <string_view>

namespace springgrasp {

enum class Phase { kSettle, kReach, kGrip, kLift, kHold, kDisturb, kAfter, kPlace, kDone };

constexpr std::string_view PhaseName(Phase phase) {
  constexpr std::string_view kNames[] = {"settle",  "reach", "grip",  "lift", "hold",
                                         "disturb", "after", "place", "done"};
  return kNames[static_cast<int>(phase)];
}

struct TrialCriteria {
  // Durations, s.
  double settle = 0.5;
  double grip = 1.5;
  double lift = 1.5;
  double hold = 2.0;
  double force_duration = 0.5;  // of each of six forces
  double shake_duration = 1.0;  // on each of three axes
  double after = 0.5;           // window after disturb
  double window = 0.5;          // averaging window of contacts
  // Of a scene whose object has a `place`: the way there, the fingers' opening, the hand's way out,
  // and how long the object must then rest.
  double place = 2.0;
  double release = 1.0;
  double retreat = 1.5;
  double rest = 0.5;
  // Magnitudes.
  double lift_height = 0.15;        // m
  double force_per_mass = 10;       // N/kg
  double shake_amplitude = 0.02;    // m
  double shake_frequency = 2;       // Hz
  double min_shake_fraction = 0.8;  // achieved amplitude over commanded
  // Verdict.
  double contact_force = 0.3;       // N, mean normal force of a finger in contact
  double max_other_load = 0.1;      // load share of hand parts that the type does not ask for
  double min_opposition_deg = 120;  // between thumb and other fingers' force
  double max_table_force = 5;       // N, any part but fingertips
  double max_tip_table_force = 10;  // N, fingertips
  double max_early_motion = 0.02;   // m, object before the first opposed contact
  double max_early_tilt_deg = 20;
  double max_slip = 0.02;  // m, in the hand from grip to the end
  double max_slip_deg = 15;
  double max_place_distance = 0.02;  // m, of the placed object from where it should stand
  double max_place_tilt_deg = 10;
  double max_place_speed = 0.005;  // m/s, of an object at rest
  double palm_like_size = 0.075;   // m: proximal phalanges count as palm for such objects
};

}  // namespace springgrasp
