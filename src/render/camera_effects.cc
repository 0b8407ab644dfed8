#include "render/camera_effects.h"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "render/camera_geometry.h"

namespace springgrasp {
namespace {

constexpr std::size_t kNoiseTable = 1 << 16;

cv::Matx33d CvMatrix(const Eigen::Matrix3d& K) {
  return {K(0, 0), K(0, 1), K(0, 2), K(1, 0), K(1, 1), K(1, 2), K(2, 0), K(2, 1), K(2, 2)};
}

// Ideal directions (x/z, y/z) of all pixels of the distorted picture, row by row.
std::vector<cv::Point2d> Undistorted(int width, int height, const cv::Matx33d& K,
                                     const std::array<double, 5>& distortion) {
  std::vector<cv::Point2d> pixels, straight;
  pixels.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) pixels.emplace_back(u, v);
  }
  const std::vector<double> k(distortion.begin(), distortion.end());
  constexpr double kEnough = 1e-4;  // px
  cv::undistortPoints(
      pixels, straight, K, k, cv::noArray(), cv::noArray(),
      cv::TermCriteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, kEnough));
  // Where the polynomial folds, no direction leads back to the pixel.
  std::vector<cv::Point3d> points;
  for (const cv::Point2d& p : straight) points.emplace_back(p.x, p.y, 1);
  std::vector<cv::Point2d> back;
  cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), K, k, back);
  for (std::size_t i = 0; i < back.size(); ++i) {
    const double miss = cv::norm(back[i] - pixels[i]);
    ThrowUnless(miss < 0.01,
                "lens distortion [{}] folds the picture of {}x{} at pixel ({}, {}); expected a "
                "weaker one",
                fmt::join(distortion, ", "), width, height, pixels[i].x, pixels[i].y);
  }
  return straight;
}

}  // namespace

LensView MakeLensView(int width, int height, double fovy_deg,
                      const std::array<double, 5>& distortion) {
  const Eigen::Matrix3d K = PinholeMatrix(fovy_deg, width, height);
  const double focal = K(0, 0);
  const std::vector<cv::Point2d> straight = Undistorted(width, height, CvMatrix(K), distortion);
  double far_x = 0, far_y = 0;
  for (const cv::Point2d& p : straight) {
    far_x = std::max(far_x, std::abs(p.x));
    far_y = std::max(far_y, std::abs(p.y));
  }
  LensView lens;
  // A pixel more on every side, for interpolation.
  const double half_width = std::ceil(focal * far_x) + 1,
               half_height = std::ceil(focal * far_y) + 1;
  ThrowUnless(half_width <= 2 * width && half_height <= 2 * height,
              "lens distortion [{}] sees more than four times as far as a pinhole; expected a "
              "weaker one",
              fmt::join(distortion, ", "));
  lens.width = 2 * static_cast<int>(half_width) + 2;
  lens.height = 2 * static_cast<int>(half_height) + 2;
  lens.fovy_deg = 2 * std::atan(lens.height / (2 * focal)) * 180 / M_PI;
  lens.map_x.create(height, width, CV_32FC1);
  lens.map_y.create(height, width, CV_32FC1);
  for (int v = 0, i = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u, ++i) {
      const cv::Point2d& p = straight[static_cast<std::size_t>(i)];
      lens.map_x.at<float>(v, u) = static_cast<float>(focal * p.x + (lens.width - 1) / 2.0);
      lens.map_y.at<float>(v, u) = static_cast<float>(focal * p.y + (lens.height - 1) / 2.0);
    }
  }
  return lens;
}

cv::Mat Distorted(const LensView& lens, const cv::Mat& ideal) {
  cv::Mat bgr;
  cv::remap(ideal, bgr, lens.map_x, lens.map_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return bgr;
}

std::vector<double> SubframeTimes(double exposure, int count) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(((i + 0.5) / count - 0.5) * exposure);
  return times;
}

void PictureMean::Add(const cv::Mat& bgr) {
  if (sum_.empty()) sum_ = cv::Mat::zeros(bgr.size(), CV_32FC3);
  cv::accumulate(bgr, sum_);
  ++count_;
}

cv::Mat PictureMean::Mean() const {
  cv::Mat bgr;
  sum_.convertTo(bgr, CV_8UC3, 1.0 / count_);
  return bgr;
}

double DriftGain(double range, double part, double phase) {
  return 1 + range / 2 * std::sin(2 * M_PI * (part + phase));
}

void ApplyGains(cv::Mat& bgr, const std::array<double, 3>& gains) {
  cv::Mat table(1, 256, CV_8UC3);
  for (int grey = 0; grey < 256; ++grey) {
    for (int c = 0; c < 3; ++c) {
      table.at<cv::Vec3b>(0, grey)[c] =
          cv::saturate_cast<unsigned char>(grey * gains[static_cast<std::size_t>(c)]);
    }
  }
  cv::LUT(bgr, table, bgr);
}

PictureNoise::PictureNoise(double deviation, RandomEngine& engine) {
  if (deviation <= 0) return;
  table_.resize(kNoiseTable);
  for (signed char& value : table_) {
    value =
        static_cast<signed char>(std::clamp(std::round(deviation * Normal(engine)), -127.0, 127.0));
  }
}

void PictureNoise::AddTo(cv::Mat& bgr, RandomEngine& engine) const {
  if (table_.empty()) return;
  const std::size_t width = static_cast<std::size_t>(bgr.cols) * 3;
  for (int row = 0; row < bgr.rows; ++row) {
    const std::size_t start = engine() % (kNoiseTable - width);
    unsigned char* pixel = bgr.ptr<unsigned char>(row);
    for (std::size_t i = 0; i < width; ++i) {
      pixel[i] = static_cast<unsigned char>(std::clamp(pixel[i] + table_[start + i], 0, 255));
    }
  }
}

}  // namespace springgrasp
