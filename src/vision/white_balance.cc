#include "vision/white_balance.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

constexpr int kGrid = 12;                       // px between pixels looked at
constexpr int kDarkest = 40, kBrightest = 250;  // levels that tell a ratio

}  // namespace

LevelTable SameLevels() {
  LevelTable table;
  for (auto& channel : table) {
    for (int i = 0; i < 256; ++i) channel[i] = static_cast<std::uint8_t>(i);
  }
  return table;
}

void WhiteBalance::SetReference(const cv::Mat& bgr, const cv::Mat* other) {
  to_other_ = {1, 1, 1};
  for (int c = 0; c < 3 && other != nullptr; ++c) {
    to_other_[c] = std::max(1.0, cv::mean(*other)[c]) / std::max(1.0, cv::mean(bgr)[c]);
  }
  pixels_.clear();
  for (int v = kGrid / 2; v < bgr.rows; v += kGrid) {
    for (int u = kGrid / 2; u < bgr.cols; u += kGrid) {
      const auto& pixel = bgr.at<cv::Vec3b>(v, u);
      pixels_.push_back({u, v, {pixel[0], pixel[1], pixel[2]}});
    }
  }
}

LevelTable WhiteBalance::LevelsOf(const cv::Mat& bgr) const {
  constexpr double kNoise = 0.02;
  constexpr std::size_t kFewest = 50;
  std::array<double, 3> gains = to_other_;
  std::vector<double> ratios;
  ratios.reserve(pixels_.size());
  for (int c = 0; c < 3; ++c) {
    ratios.clear();
    for (const Pixel& pixel : pixels_) {
      const int before = pixel.bgr[c], now = bgr.at<cv::Vec3b>(pixel.v, pixel.u)[c];
      if (std::min(before, now) < kDarkest || std::max(before, now) > kBrightest) continue;
      ratios.push_back(static_cast<double>(before) / now);
    }
    if (ratios.size() < kFewest) continue;
    const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
    std::nth_element(ratios.begin(), middle, ratios.end());
    gains[c] *= *middle;
  }
  const double brightness = std::cbrt(gains[0] * gains[1] * gains[2]);
  LevelTable table = SameLevels();
  for (int c = 0; c < 3; ++c) {
    const double gain = gains[c] / brightness;
    if (std::abs(gain - 1) < kNoise) continue;
    for (int i = 0; i < 256; ++i) {
      table[c][i] = static_cast<std::uint8_t>(std::clamp(std::lround(gain * i), 0L, 255L));
    }
  }
  return table;
}

}  // namespace springgrasp
