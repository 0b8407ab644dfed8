// What real cameras do to an ideal picture: lens, exposure, gains, sensor noise.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "base/random.h"

namespace springgrasp {

// An ideal picture that holds all that a distorting lens sees, and where in it each pixel of the
// distorted picture lies. Both have the same focal length (px) and their axis in the middle.
struct LensView {
  int width = 0, height = 0;  // px, of the ideal picture
  double fovy_deg = 0;        // of the ideal picture
  cv::Mat map_x, map_y;       // CV_32FC1, of the size of the distorted picture
};

// `fovy_deg`: of a pinhole camera of width x height with the lens's focal length; `distortion`:
// OpenCV's k1 k2 p1 p2 k3. Throws Error if the lens folds the picture, or sees so far to the side
// that no flat picture holds it.
LensView MakeLensView(int width, int height, double fovy_deg,
                      const std::array<double, 5>& distortion);
// The picture behind the lens.
cv::Mat Distorted(const LensView& lens, const cv::Mat& ideal);

// Middles of `count` equal parts of an exposure, from its own middle, s.
std::vector<double> SubframeTimes(double exposure, int count);

// Mean of pictures that are shown for equal times, CV_8UC3.
class PictureMean {
 public:
  void Add(const cv::Mat& bgr);
  cv::Mat Mean() const;

 private:
  cv::Mat sum_;  // CV_32FC3
  int count_ = 0;
};

// Gain that swings once about 1 over a sequence: `range` is the largest less the smallest,
// `part` how much of the sequence is over, `phase` where the swing begins (turns).
double DriftGain(double range, double part, double phase);
// Multiplies blue, green and red; what is too bright becomes 255.
void ApplyGains(cv::Mat& bgr, const std::array<double, 3>& gains);

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
