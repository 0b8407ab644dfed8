// A trial that ends with the tracking: how well it was seen.
#pragma once

#include <string>

#include "demonstration/demonstration.h"
#include "experiment/trial_result.h"
#include "experiment/trial_spec.h"

namespace springgrasp {

// An involved finger seen in fewer than 60 % of frames, or not in the last 0.15 s, where the
// demonstrating hand holds the object (the contract counts from the contact); empty: neither.
std::string WhyUntracked(const Demonstration& demonstration, const PerFinger<bool>& involved);

// Outcome `success` or `untracked`. Files below output.folder: demonstration.csv, truth.csv,
// tracking.csv (tracking_errors.h), tracking.mp4. Measurements: frames, tip_median_mm, tip_95_mm,
// <finger>_median_mm, <finger>_95_mm, hand_median_mm, hand_95_mm, hand_median_deg, hand_95_deg,
// coverage (of visible fingertips), swap_frames, swap_fraction, hidden and recovered_in_5 (caps),
// recovery_frames (worst), epipolar_px. Throws Error for a scene that cannot be used.
TrialResult RunObserveTrial(const TrialSpec& spec, const TrialOutput& output);

}  // namespace springgrasp
