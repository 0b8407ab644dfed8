// Two recorded videos as a source of stereo frames.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "vision/track_demonstration.h"

namespace springgrasp {

// Files or image patterns as cv::VideoCapture takes them ("left.mp4", "left_%04d.png"). Frame i of
// both belongs to the time i / fps. Throws Error when one cannot be read, holds no frame, differs
// in size from the other, or is smaller than 320x240 or larger than 1920x1080.
class RecordedStereo {
 public:
  // `fps` in Hz; 0: that of the left video (image patterns have none: Error).
  RecordedStereo(const std::string& left, const std::string& right, double fps = 0);
  ~RecordedStereo();
  RecordedStereo(const RecordedStereo&) = delete;
  RecordedStereo& operator=(const RecordedStereo&) = delete;

  cv::Size size() const;
  double fps() const;
  // The next pair, or nothing at the end. Throws Error if only one of the two has ended.
  std::optional<StereoFrame> Next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace springgrasp
