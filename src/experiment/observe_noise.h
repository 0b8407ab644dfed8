// Noise of the simulated cameras' sensors.
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "base/random.h"

namespace springgrasp {

// Adds normal noise of one deviation to every channel of a picture. A table of draws is made once
// and read from another place in every row, so that a picture costs no million draws.
class PictureNoise {
 public:
  // `deviation` in grey values; 0: pictures stay as they are and nothing is drawn.
  PictureNoise(double deviation, RandomEngine& engine);
  void AddTo(cv::Mat& bgr, RandomEngine& engine) const;

 private:
  std::vector<signed char> table_;
};

}  // namespace springgrasp
