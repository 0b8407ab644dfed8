#include "vision/recorded_stereo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/error.h"

namespace springgrasp {

namespace fs = std::filesystem;

namespace {

constexpr long kMostFrames = 100'000'000;  // beyond: a count that the file does not know

// What is wrong is said in the project's own words, once.
void SilenceReaders() {
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

// "left_%04d.png", or one picture of a numbered series.
bool IsPictures(const std::string& path) {
  if (path.find('%') != std::string::npos) return true;
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), ::tolower);
  for (const char* known : {".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".ppm"}) {
    if (extension == known) return true;
  }
  return false;
}

// Pictures of a pattern without a gap; OpenCV's own count stops at one that it cannot decode.
// Requires a pattern that OpenCV opened: it takes none but those with a single %d.
long CountPictures(const std::string& pattern) {
  constexpr int kLatestFirst = 1000;  // index of the first picture
  int first = 0;
  while (first <= kLatestFirst && !fs::exists(cv::format(pattern.c_str(), first))) ++first;
  int end = first;
  while (fs::exists(cv::format(pattern.c_str(), end))) ++end;
  return end - first;
}

}  // namespace

struct RecordedStereo::Impl {
  struct Side {
    std::string path;
    cv::VideoCapture capture;
    cv::Mat ahead;       // the next frame, read already; empty at the end
    double time_ms = 0;  // of it, as the file says; 0 for pictures
    double first_ms = 0;
    long announced = 0;  // frames; 0: not known
  };
  std::array<Side, 2> sides;
  cv::Size size;
  double fps = 0, file_fps = 0;
  long count = 0;
  bool ended = false;
  std::optional<std::string> broke_off;

  void Open(Side& side, const std::string& path) {
    side.path = path;
    const bool pictures = IsPictures(path);
    std::error_code ignored;
    ThrowUnless(path.find('%') != std::string::npos || fs::is_regular_file(path, ignored),
                "{}: no such video", path);
    bool opened = false;
    try {
      opened = side.capture.open(path, pictures ? cv::CAP_IMAGES : cv::CAP_FFMPEG);
    } catch (const cv::Exception&) {
      // Reported below in the project's own words.
    }
    ThrowUnless(
        opened, "{}: {}", path,
        pictures ? "no pictures of that name that OpenCV reads" : "not a video that OpenCV reads");
    const double announced = side.capture.get(cv::CAP_PROP_FRAME_COUNT);
    if (announced > 0 && announced < kMostFrames) side.announced = std::lround(announced);
    if (path.find('%') != std::string::npos) {
      side.announced = std::max(side.announced, CountPictures(path));
    }
    Read(side);
    ThrowUnless(!side.ahead.empty(), "{}: holds no picture that can be read", path);
    ThrowUnless(side.ahead.type() == CV_8UC3, "{}: expected pictures of three colours, 8 bit each",
                path);
    side.first_ms = side.time_ms;
  }

  // A picture of its own: the capture reuses its buffer.
  static void Read(Side& side) {
    cv::Mat frame;
    bool read = false;
    try {
      read = side.capture.read(frame);
    } catch (const cv::Exception&) {
      // A picture that cannot be decoded ends the video.
    }
    side.ahead = cv::Mat();
    if (!read) return;
    if (frame.type() == CV_8UC4) {
      cv::cvtColor(frame, side.ahead, cv::COLOR_BGRA2BGR);
    } else {
      side.ahead = frame.clone();
    }
    side.time_ms = side.capture.get(cv::CAP_PROP_POS_MSEC);
  }

  void CheckRates(double asked) {
    const Side &left = sides[0], &right = sides[1];
    std::array<double, 2> rates = {};
    for (int i = 0; i < 2; ++i) {
      if (!IsPictures(sides[i].path)) rates[i] = sides[i].capture.get(cv::CAP_PROP_FPS);
      if (!std::isfinite(rates[i])) rates[i] = 0;
    }
    file_fps = rates[0];
    ThrowUnless(std::isfinite(asked) && (asked == 0 || (asked >= 5 && asked <= 1000)),
                "--fps is {}, expected 5 to 1000", asked);
    fps = asked > 0 ? asked : rates[0];
    if (asked > 0) return;
    ThrowUnless(!IsPictures(left.path), "{}: pictures do not tell their rate, give --fps",
                left.path);
    ThrowUnless(fps >= 5 && fps <= 1000, "{}: {} frames per second, expected 5 to 1000; give --fps",
                left.path, fps);
    ThrowUnless(std::abs(rates[1] - fps) < 0.01 * fps,
                "{}: {} frames per second, expected {} as in {}; or give --fps", right.path,
                rates[1], fps, left.path);
  }

  // Why there is no further pair; nothing at the regular end.
  std::optional<std::string> Break() const {
    const Side &left = sides[0], &right = sides[1];
    const auto at = [&](const std::string& what) {
      return fmt::format("{} after {} frames, at {:.3f} s", what, count,
                         static_cast<double>(count) / fps);
    };
    for (const Side& side : sides) {
      if (!side.ahead.empty()) continue;
      const bool alone = left.ahead.empty() != right.ahead.empty();
      const long missing = side.announced - count;
      if (!alone && missing <= 1) continue;
      if (missing <= 0) return at(side.path + ": ends before the other video,");
      return at(fmt::format("{}: breaks off ({} frames announced)", side.path, side.announced));
    }
    if (left.ahead.empty()) return std::nullopt;
    for (const Side& side : sides) {
      if (side.ahead.size() == size && side.ahead.type() == CV_8UC3) continue;
      return at(fmt::format("{}: goes on with pictures of {}x{}", side.path, side.ahead.cols,
                            side.ahead.rows));
    }
    // Decoders skip what they cannot read: the two would be out of step from there on.
    const double ahead_ms = (left.time_ms - left.first_ms) - (right.time_ms - right.first_ms);
    if (file_fps > 0 && std::abs(ahead_ms) > 600 / file_fps) {
      return at((ahead_ms > 0 ? left : right).path + ": pictures are missing");
    }
    return std::nullopt;
  }
};

RecordedStereo::RecordedStereo(const std::string& left, const std::string& right, double fps)
    : impl_(std::make_unique<Impl>()) {
  SilenceReaders();
  auto& [first, second] = impl_->sides;
  impl_->Open(first, left);
  impl_->Open(second, right);
  impl_->size = first.ahead.size();
  const cv::Size size = impl_->size, other = second.ahead.size();
  ThrowUnless(size == other, "{}: pictures of {}x{}, expected {}x{} as in {}", right, other.width,
              other.height, size.width, size.height, left);
  ThrowUnless(size.width >= 320 && size.height >= 240 && size.width <= 1920 && size.height <= 1080,
              "{}: pictures of {}x{}, expected 320x240 to 1920x1080", left, size.width,
              size.height);
  ThrowUnless(first.announced == second.announced || first.announced == 0 || second.announced == 0,
              "{}: {} frames, expected {} as in {}", right, second.announced, first.announced,
              left);
  impl_->CheckRates(fps);
}

RecordedStereo::~RecordedStereo() = default;

cv::Size RecordedStereo::size() const { return impl_->size; }

double RecordedStereo::fps() const { return impl_->fps; }

const std::optional<std::string>& RecordedStereo::broke_off() const { return impl_->broke_off; }

std::optional<StereoFrame> RecordedStereo::Next() {
  auto& [left, right] = impl_->sides;
  if (impl_->ended) return std::nullopt;
  impl_->broke_off = impl_->Break();
  if (impl_->broke_off || left.ahead.empty()) {
    impl_->ended = true;
    return std::nullopt;
  }
  StereoFrame frame{static_cast<double>(impl_->count) / impl_->fps, left.ahead, right.ahead};
  ++impl_->count;
  Impl::Read(left);
  Impl::Read(right);
  return frame;
}

}  // namespace springgrasp
