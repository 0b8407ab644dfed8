// Frames to an H.264 MP4 that browsers play, seen by readers only when complete.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>

namespace springgrasp {

class VideoWriter {
 public:
  // `path` ends in .mp4. The size is that of the first frame (even numbers). Throws Error when the
  // file cannot be opened or this OpenCV has no H.264.
  VideoWriter(std::string path, double fps);
  // Without Finish() the video is dropped.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  void Add(const cv::Mat& bgr);
  // Closes the file and moves it to `path`. Throws Error if no frame was added.
  void Finish();
  int frames() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// White text with a dark edge; `line` counts from the top (negative: from the bottom).
void DrawText(cv::Mat& bgr, const std::string& text, int line = 0);

// Writes a picture through a temporary name. Throws Error.
void WriteImage(const std::string& path, const cv::Mat& bgr);

}  // namespace springgrasp
