// How a camera's white balance has drifted since a reference picture.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

namespace springgrasp {

// For each channel (BGR) what a level of the present picture would be under the reference's white
// balance; brightness stays.
using LevelTable = std::array<std::array<std::uint8_t, 256>, 3>;

LevelTable SameLevels();

// Keeps a grid of pixels of the reference picture. The camera is at rest and most of the picture is
// not the hand: the median over the grid of how much brighter a channel has become is its drift,
// but for what all channels share.
class WhiteBalance {
 public:
  // Takes a CV_8UC3 picture as the reference. With `other`, the other eye's picture at that time,
  // levels become those of the other eye, whose picture is as bright on the whole.
  void SetReference(const cv::Mat& bgr, const cv::Mat* other = nullptr);
  bool has_reference() const { return !pixels_.empty(); }
  // Levels of a picture of the same size. Below 0.02 of drift, which noise alone may give, none.
  LevelTable LevelsOf(const cv::Mat& bgr) const;

 private:
  struct Pixel {
    int u, v;
    std::array<std::uint8_t, 3> bgr;
  };
  std::vector<Pixel> pixels_;
  std::array<double, 3> to_other_ = {1, 1, 1};
};

}  // namespace springgrasp
