// Two recorded videos as a source of stereo frames.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>

#include "vision/track_demonstration.h"

namespace springgrasp {

// Files or image patterns as cv::VideoCapture takes them ("left.mp4", "left_%04d.png"), by FFmpeg
// and OpenCV's reader of pictures. Frame i of both belongs to the time i / fps. Throws Error when
// one cannot be read, holds no frame, differs from the other in size, length or rate, or is smaller
// than 320x240 or larger than 1920x1080.
class RecordedStereo {
 public:
  // `fps` in Hz; 0: that of the videos (image patterns have none: Error).
  RecordedStereo(const std::string& left, const std::string& right, double fps = 0);
  ~RecordedStereo();
  RecordedStereo(const RecordedStereo&) = delete;
  RecordedStereo& operator=(const RecordedStereo&) = delete;

  cv::Size size() const;
  double fps() const;
  // The next pair, or nothing at the end.
  std::optional<StereoFrame> Next();
  // After the end: one line saying which file broke off, where and why, if that was before the
  // length that both files announce: a picture that cannot be decoded, a file cut off, pictures
  // missing from one of the two. A file's count may be one too high, so one less is no break.
  const std::optional<std::string>& broke_off() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace springgrasp
