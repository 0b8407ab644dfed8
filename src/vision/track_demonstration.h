// Stereo pictures -> DEMONSTRATION: fingertips, hand pose, and what an overlay video shows.
#pragma once

#include <functional>
#include <optional>

#include "base/error.h"
#include "base/random.h"
#include "demonstration/demonstration.h"
#include "vision/fingertip_tracker.h"
#include "vision/hand_pose.h"
#include "vision/stereo_frame.h"

namespace springgrasp {

// The next frame, or nothing at the end.
using FrameSource = std::function<std::optional<StereoFrame>()>;

struct TrackDemonstrationOptions {
  TrackerOptions tracker;
  HandPoseOptions hand_pose;
  std::optional<DemonstratedObject> object;  // that may hide the hand
  double lead_in = 0;   // s from the first frame, dropped; times start anew after it
  double max_wait = 2;  // s until the caps must have been found
  // s during which the hand's length is estimated: it settles before a lead-in of 0.5 s is over.
  double scale_time = 0.35;
  double smoothing = 0.1;       // s, half window of the hand's track; 0: none
  std::string frame = "world";  // what W stands for, written into the demonstration
};

// What was made of one frame, for overlays and experiments; pointers live during the call only.
struct TrackedInstant {
  const StereoFrame& frame;
  const TrackedFrame& tracked;
  const HandFit* hand = nullptr;  // null without a hand model or before its first fit
  const FingertipTracker& tracker;
};
using InstantCallback = std::function<void(const TrackedInstant&)>;

// What else came out of it, for the trial's record.
struct TrackingSummary {
  int frames = 0;                   // tracked, lead-in included
  PerFinger<double> coverage = {};  // share of frames in which the finger was located, no lead-in
  double epipolar_px = 0;           // median residual of located fingers
  double hand_scale = 0;            // of the hand model; 0 without
  CapShape cap;
};

// No caps were found.
class NotTracked : public Error {
 public:
  using Error::Error;
};

// Tracks all frames. `hand` (root H, frames mmm_<finger>_tip) gives the pose of H; without it the
// wrist stays absent. Throws Error if there is no frame, NotTracked if no caps were found within
// max_wait.
Demonstration TrackStereo(const FrameSource& source, const StereoCameras& cameras,
                          const KinematicTree* hand, const TrackDemonstrationOptions& options,
                          RandomEngine& engine, const InstantCallback& on_frame = {},
                          TrackingSummary* summary = nullptr);

}  // namespace springgrasp
