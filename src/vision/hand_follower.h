// The whole hand beside its fingertips: finds out at the start which caps are a hand's and whose,
// and follows the pose of H from frame to frame.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "demonstration/demonstration.h"
#include "vision/fingertip_tracker.h"
#include "vision/hand_pose.h"
#include "vision/stereo_frame.h"

namespace springgrasp {

// Owns the fit of the last frame and what the lead-in told of the arm.
class HandFollower {
 public:
  // `object`: shown with the hand, may hide it.
  HandFollower(const KinematicTree& tree, const StereoCameras& cameras,
               const HandPoseOptions& options, const std::optional<DemonstratedObject>& object);

  // Starts tracker and fit with the set of caps and the labels that look most like a hand. Nothing
  // if no set does, unless it `must` be one: call again with the next frame.
  std::optional<TrackedFrame> Start(FingertipTracker& tracker, const StereoFrame& frame, bool must);

  // The fit to a tracked frame; nothing as long as the hand was not found. Of the frame of the
  // start it is the start's.
  const HandFit* Follow(const StereoFrame& frame, const TrackedFrame& tracked,
                        const FingertipTracker& tracker, bool fit_scale);

  // After Follow: labels with which the hand fits the frame better (finger f's cap is the one that
  // order[f] has), where it has not fitted for some frames, or for fingers that come back together.
  // Taken over into fit and `tracked`; where it is not sure yet whose a cap is, no finger is
  // reported.
  std::optional<PerFinger<int>> BetterLabels(const StereoFrame& frame,
                                             const FingertipTracker& tracker,
                                             TrackedFrame& tracked);

  const HandModel& model() const { return model_; }

 private:
  HandObservation Observe(const StereoFrame& frame, const TrackedFrame& tracked,
                          const FingertipTracker& tracker);
  bool Segment(int v, const cv::Mat& bgr, const TrackedFrame& tracked,
               const FingertipTracker& tracker);
  std::vector<PerFinger<int>> LikelyLabels(const TrackedFrame& tracked) const;
  // Labels as for BetterLabels, and fingers of which it is not sure that the cap is theirs.
  struct Returning {
    PerFinger<int> order;
    PerFinger<bool> unsure;
  };
  void Advance();
  void Restart(const HandObservation& seen);
  Returning LabelsOfReturning(const HandObservation& seen);
  HandFit Refit(const HandObservation& seen, const PerFinger<int>& order, const HandFit& last,
                const HandStep& step, const HandPoseOptions& options) const;
  void CountForearm();

  HandModel model_;
  std::vector<int> forearm_seen_;
  std::vector<double> sleeve_x_;  // m, of the frames of the lead-in in which it was seen
  int forearm_frames_ = 0;
  StereoCameras cameras_;
  HandPoseOptions options_;
  std::array<HandMask, 2> masks_;
  std::array<WhiteBalance, 2> white_balance_;  // since the skin was learned
  PerFinger<int> lost_for_ = {};               // frames
  PerFinger<int> back_since_ = {};     // frames since a lost finger was seen again; large: long ago
  std::optional<HandFit> fit_before_;  // of the last frame
  HandStep step_before_;
  int unfit_frames_ = 0;   // for how long the hand has not fitted its tips
  int astray_frames_ = 0;  // for how long it has fitted the pictures badly
  std::optional<KnownObject> object_;
  std::optional<HandFit> fit_;
  bool fresh_ = false;  // the fit is of the frame at hand
  HandStep step_;
};

}  // namespace springgrasp
