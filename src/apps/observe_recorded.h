// springgrasp observe on recorded stereo video.
#pragma once

#include <string>

namespace springgrasp {

struct ObserveRecordedOptions {
  std::string left, right;             // videos or image patterns
  std::string intrinsics, extrinsics;  // as OpenCV's stereo_calib sample writes them
  std::string output, overlay;
  std::string camera_pose;  // "x y z qw qx qy qz" of the left camera in W; empty: W is the camera
  std::string marker_hue = "120";  // degrees, or auto
  double fps = 0;                  // 0: the video's
  std::uint64_t seed = 1;
};

// Tracks, writes the demonstration, prints coverage and epipolar residual. Throws Error.
void ObserveRecorded(const ObserveRecordedOptions& options);

}  // namespace springgrasp
