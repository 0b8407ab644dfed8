// springgrasp observe on recorded stereo video.
#pragma once

#include <cstdint>
#include <string>

#include "vision/fingertip_tracker.h"

namespace springgrasp {

struct ObserveRecordedOptions {
  std::string left, right;             // videos or image patterns
  std::string intrinsics, extrinsics;  // as OpenCV's stereo_calib sample writes them
  std::string output, overlay;
  std::string truth;               // to be compared with, in the left camera's frame; may be empty
  std::string camera_pose;         // of the left camera in W, as ParsePose; empty: W is the camera
  std::string marker_hue = "120";  // degrees, or auto
  double cap_diameter = 0, cap_length = 0;  // m; 0: found, usual
  double cap_centre = 0;       // m, from a cap's end to what is reported; 0: its radius
  std::string hand = "right";  // right | left: that shows its palm
  bool particles = false;      // drawn into the overlay
  TrackerKind tracker = TrackerKind::kOutline;
  double fps = 0;  // 0: the video's
  std::uint64_t seed = 1;
};

// Tracks, writes the demonstration, prints coverage and epipolar residual, with truth the errors.
// Returns the exit code: kStoppedEarly if a video broke off and what was tracked until then is
// kept, else kDone. Throws Error before anything is written.
int ObserveRecorded(const ObserveRecordedOptions& options);

}  // namespace springgrasp
