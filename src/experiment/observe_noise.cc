#include "experiment/observe_noise.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

constexpr std::size_t kTable = 1 << 16;

}  // namespace

PictureNoise::PictureNoise(double deviation, RandomEngine& engine) {
  if (deviation <= 0) return;
  table_.resize(kTable);
  for (signed char& value : table_) {
    value =
        static_cast<signed char>(std::clamp(std::round(deviation * Normal(engine)), -127.0, 127.0));
  }
}

void PictureNoise::AddTo(cv::Mat& bgr, RandomEngine& engine) const {
  if (table_.empty()) return;
  const std::size_t width = static_cast<std::size_t>(bgr.cols) * 3;
  for (int row = 0; row < bgr.rows; ++row) {
    const std::size_t start = engine() % (kTable - width);
    unsigned char* pixel = bgr.ptr<unsigned char>(row);
    for (std::size_t i = 0; i < width; ++i) {
      pixel[i] = static_cast<unsigned char>(std::clamp(pixel[i] + table_[start + i], 0, 255));
    }
  }
}

}  // namespace springgrasp
