#include "render/video_writer.h"

#include <unistd.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/error.h"
#include "base/files.h"

namespace springgrasp {

namespace fs = std::filesystem;

struct VideoWriter::Impl {
  std::string path;
  std::string temporary;
  double fps = 30;
  int frames = 0;
  cv::Size size;
  cv::VideoWriter writer;
};

VideoWriter::VideoWriter(std::string path, double fps) : impl_(std::make_unique<Impl>()) {
  const fs::path target(path);
  ThrowUnless(target.extension() == ".mp4", "{}: a video's name must end in .mp4", path);
  ThrowUnless(fps > 0 && fps <= 1000, "{}: {} frames per second, expected up to 1000", path, fps);
  impl_->temporary =
      (target.parent_path() / fmt::format(".{}.{}.tmp.mp4", target.stem().string(), getpid()))
          .string();
  impl_->path = std::move(path);
  impl_->fps = fps;
}

VideoWriter::~VideoWriter() {
  if (impl_ == nullptr) return;
  impl_->writer.release();
  std::error_code ignored;
  fs::remove(impl_->temporary, ignored);
}

void VideoWriter::Add(const cv::Mat& bgr) {
  ThrowUnless(bgr.type() == CV_8UC3 && !bgr.empty(), "{}: a frame must be 8-bit BGR", impl_->path);
  if (impl_->frames == 0) {
    impl_->size = bgr.size();
    ThrowUnless(bgr.cols % 2 == 0 && bgr.rows % 2 == 0,
                "{}: frames of {}x{}, expected even numbers", impl_->path, bgr.cols, bgr.rows);
    impl_->writer.open(impl_->temporary, cv::CAP_FFMPEG,
                       cv::VideoWriter::fourcc('a', 'v', 'c', '1'), impl_->fps, impl_->size);
    ThrowUnless(impl_->writer.isOpened(),
                "{}: the video cannot be written (folder missing, or "
                "OpenCV without H.264)",
                impl_->path);
  }
  ThrowUnless(bgr.size() == impl_->size, "{}: a frame of {}x{} among frames of {}x{}", impl_->path,
              bgr.cols, bgr.rows, impl_->size.width, impl_->size.height);
  impl_->writer.write(bgr);
  ++impl_->frames;
}

void VideoWriter::Finish() {
  ThrowUnless(impl_->frames > 0, "{}: a video without frames", impl_->path);
  impl_->writer.release();
  // The encoder does not tell of a full disk.
  const cv::VideoCapture written(impl_->temporary, cv::CAP_FFMPEG);
  std::error_code error;
  if (!written.isOpened() || written.get(cv::CAP_PROP_FRAME_COUNT) != impl_->frames) {
    error = std::make_error_code(std::errc::io_error);
  } else {
    fs::rename(impl_->temporary, impl_->path, error);
  }
  if (error)
    throw NotWritten(fmt::format("{}: cannot be written ({})", impl_->path, error.message()));
}

int VideoWriter::frames() const { return impl_->frames; }

void DrawText(cv::Mat& bgr, const std::string& text, int line) {
  const double scale = bgr.rows / 720.0;
  const int step = static_cast<int>(30 * scale);
  const int y = line >= 0 ? step * (line + 1) : bgr.rows + step * line + step / 2;
  const cv::Point at(static_cast<int>(12 * scale), y);
  const double font = 0.75 * scale;
  const int thin = std::max(1, static_cast<int>(1.6 * scale));
  cv::putText(bgr, text, at, cv::FONT_HERSHEY_SIMPLEX, font, cv::Scalar(20, 20, 20), thin + 3,
              cv::LINE_AA);
  cv::putText(bgr, text, at, cv::FONT_HERSHEY_SIMPLEX, font, cv::Scalar(255, 255, 255), thin,
              cv::LINE_AA);
}

void WriteImage(const std::string& path, const cv::Mat& bgr) {
  WriteThroughTemporary(path, [&](const std::string& temporary) {
    bool written = false;
    try {
      written = cv::imwrite(temporary, bgr);
    } catch (const cv::Exception& e) {
      throw NotWritten(fmt::format("{}: the picture cannot be written ({})", path, e.err));
    }
    if (!written) throw NotWritten(fmt::format("{}: the picture cannot be written", path));
  });
}

}  // namespace springgrasp
