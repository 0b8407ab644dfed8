// STEREO FRAME: what both eyes see at one time.
#pragma once

#include <opencv2/core.hpp>

namespace springgrasp {

struct StereoFrame {
  double t = 0;         // s
  cv::Mat left, right;  // CV_8UC3, BGR
};

}  // namespace springgrasp
