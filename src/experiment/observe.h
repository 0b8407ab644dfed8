// OBSERVE: a demonstration performed before the robot's eyes, as the tracker sees it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/random.h"
#include "demonstration/demonstration.h"
#include "demonstration/hand_motion.h"
#include "experiment/observe_stage.h"
#include "experiment/tracking_errors.h"
#include "sim/scene.h"
#include "vision/track_demonstration.h"

namespace springgrasp {

struct ObserveOptions {
  double fps = 30;  // of the eyes, Hz (the paper's: 23)
  // In the place of what the scene says of its eyes:
  std::optional<double> noise;         // deviation of the pictures' grey values, 0..255
  std::optional<std::string> tracker;  // outline | paper
  bool measure_visible = true;  // count each cap's visible pixels (adds some 40 % of the time)
  std::string overlay;          // video of the tracking (.mp4), if not empty
  bool particles = false;       // drawn into the overlay
  bool throw_untracked = true;  // else Observation::untracked tells that no caps were found
  std::string frames_folder;    // existing folder for left_0000.png, right_0000.png, if not empty
};

// Tracked against shown; lead-in left out.
struct ObservationErrors {
  PerFinger<double> median = {}, p95 = {};  // m, while visible or not known; 0 if never
  PerFinger<int> counted = {};              // samples behind these
  PerFinger<double> coverage = {};          // tracked part of the instants in which it was visible
  PerFinger<double> seen = {};              // tracked part of all instants
  double median_all = 0, p95_all = 0;       // m, over all fingers and instants that count
  double coverage_all = 0;                  // likewise
  int label_swaps = 0;                      // a fingertip reported where another one is
  int swap_frames = 0;                      // instants with one or more of these
  double wrist_median = 0, wrist_p95 = 0;   // m
  double wrist_rotation_median_deg = 0, wrist_rotation_p95_deg = 0;
  double wrist_coverage = 0, rotation_coverage = 0;  // part of all instants
};

struct Observation {
  HandMotion shown;       // as performed: placed, with lead-in (t < 0), at the eyes' rate
  Demonstration truth;    // fingertips and hand of what was shown, from t = 0
  Demonstration tracked;  // what the pictures told; same instants as `truth`
  // Per instant of `truth` the smaller of both eyes' visible fractions, 0 for a fingertip that the
  // recording did not see; empty if not measured.
  std::vector<PerFinger<double>> visible;
  ObservationErrors errors;
  TrackingSummary summary;  // the tracker's own account
  std::string untracked;    // why nothing was tracked at all; empty if something was
};

// The shape that the scene's demonstrator shows: `demonstrator.object`, or the first object's;
// recordings have none unless their file tells.
std::optional<Shape> ShownShape(const Scene& scene);

// What the scene's demonstrator does: synthesised, or recorded and put on the MMM hand; placed
// before the eyes, lead-in first. Throws Error for a demonstration that cannot be shown.
HandMotion PrepareDemonstration(const Scene& scene, const ObserveStage& stage,
                                RandomEngine& engine);

// Renders and tracks `motion` (placed, with lead-in). The tracker is told the cameras as
// calibrated, the hue of caps that are not green and, if it is in the picture, the object that the
// demonstration tells of; nothing else: how long the hand is it finds out.
Observation ObserveMotion(ObserveStage& stage, const HandMotion& motion, RandomEngine& engine,
                          const ObserveOptions& options = {});

// All of it for one scene.
Observation Observe(const Scene& scene, RandomEngine& engine, const ObserveOptions& options = {});

// Fingertips and hand of a motion from t = 0 as a demonstration.
Demonstration TruthOf(const DemonstratorHand& hand, const HandMotion& motion);

ObservationErrors SummariseFrames(const std::vector<TrackingFrame>& frames);
ObservationErrors CompareToTruth(const Demonstration& tracked, const Demonstration& truth,
                                 const std::vector<PerFinger<double>>& visible);

}  // namespace springgrasp
