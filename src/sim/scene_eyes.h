// EYES: how the robot's wide-angle cameras differ from perfect ones. All off by default.
#pragma once

#include <array>
#include <string>

namespace springgrasp {

// What the tracker is told of the cameras, less what is true.
struct SceneCalibrationError {
  double rotation = 0;  // rad, of the right camera, about an axis that is drawn
  double focal = 0;     // fraction, of both focal lengths
};

struct SceneEyes {
  int width = 640, height = 480;          // px; the vertical field of view stays
  double noise = 0;                       // deviation of every grey value, 0..255
  std::array<double, 5> distortion = {};  // OpenCV's k1 k2 p1 p2 k3; the tracker knows them
  double exposure = 0;                    // s; a picture's time is the middle of it
  int subframes = 16;           // at most, that an exposure is made of: one per pixel of movement
  double brightness_drift = 0;  // largest less smallest gain over the sequence
  double white_balance_drift = 0;  // the same of each channel by itself
  double frame_drops = 0;          // probability that a pair is missing
  double time_offset = 0;          // s, by which the right eye is later than the left
  SceneCalibrationError calibration_error;
  std::string tracker = "outline";  // outline | paper: who tracks (vision/fingertip_tracker.h)
};

}  // namespace springgrasp
