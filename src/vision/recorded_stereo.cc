#include "vision/recorded_stereo.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/videoio.hpp>

#include "base/error.h"

namespace springgrasp {

struct RecordedStereo::Impl {
  std::array<std::string, 2> paths;
  std::array<cv::VideoCapture, 2> captures;
  std::array<cv::Mat, 2> ahead;  // the next frames, read already; empty at the end
  double fps = 0;
  long count = 0;

  void Open(int side, const std::string& path) {
    paths[side] = path;
    const bool pattern = path.find('%') != std::string::npos;
    ThrowUnless(pattern || std::filesystem::is_regular_file(path), "{}: no such video", path);
    bool opened = false;
    try {
      opened = captures[side].open(path);
    } catch (const cv::Exception&) {
      // Reported below in the project's own words.
    }
    ThrowUnless(opened, "{}: not a video or image sequence that OpenCV reads", path);
    Read(side);
    ThrowUnless(!ahead[side].empty(), "{}: the video holds no frame", path);
    ThrowUnless(ahead[side].type() == CV_8UC3, "{}: expected pictures of three colours, 8 bit each",
                path);
  }

  // A picture of its own: the capture reuses its buffer.
  void Read(int side) {
    cv::Mat frame;
    ahead[side] = captures[side].read(frame) ? frame.clone() : cv::Mat();
  }
};

RecordedStereo::RecordedStereo(const std::string& left, const std::string& right, double fps)
    : impl_(std::make_unique<Impl>()) {
  impl_->Open(0, left);
  impl_->Open(1, right);
  const cv::Size first = impl_->ahead[0].size(), second = impl_->ahead[1].size();
  ThrowUnless(first == second, "{}: pictures of {}x{}, expected {}x{} as in {}", right,
              second.width, second.height, first.width, first.height, left);
  ThrowUnless(
      first.width >= 320 && first.height >= 240 && first.width <= 1920 && first.height <= 1080,
      "{}: pictures of {}x{}, expected 320x240 to 1920x1080", left, first.width, first.height);
  impl_->fps = fps > 0 ? fps : impl_->captures[0].get(cv::CAP_PROP_FPS);
  const bool told = fps > 0 || left.find('%') == std::string::npos;
  ThrowUnless(told && std::isfinite(impl_->fps) && impl_->fps >= 5 && impl_->fps <= 1000,
              "{}: frames per second are {}, give --fps (5 to 1000)", left,
              told ? fmt::format("{}", impl_->fps) : "not told by pictures");
}

RecordedStereo::~RecordedStereo() = default;

cv::Size RecordedStereo::size() const { return impl_->ahead[0].size(); }

double RecordedStereo::fps() const { return impl_->fps; }

std::optional<StereoFrame> RecordedStereo::Next() {
  auto& ahead = impl_->ahead;
  if (ahead[0].empty() && ahead[1].empty()) return std::nullopt;
  const int ended = ahead[0].empty() ? 0 : 1;
  ThrowUnless(!ahead[ended].empty(), "{}: ends after {} frames, {} goes on", impl_->paths[ended],
              impl_->count, impl_->paths[1 - ended]);
  StereoFrame frame{static_cast<double>(impl_->count) / impl_->fps, ahead[0], ahead[1]};
  ++impl_->count;
  impl_->Read(0);
  impl_->Read(1);
  return frame;
}

}  // namespace springgrasp
