#include "vision/marker_colour.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vision/marker_segmentation.h"

namespace springgrasp {
namespace {

struct Hsv {
  double hue_deg, saturation, value;
};

Hsv ToHsv(double b, double g, double r) {
  const double high = std::max({b, g, r}), low = std::min({b, g, r}), span = high - low;
  if (span <= 0) return {0, 0, high / 255};
  double hue = 0;
  if (high == r) {
    hue = (g - b) / span;
  } else if (high == g) {
    hue = 2 + (b - r) / span;
  } else {
    hue = 4 + (r - g) / span;
  }
  return {60 * (hue < 0 ? hue + 6 : hue), span / high, high / 255};
}

// Middle of the colours that share a table entry.
Hsv EntryHsv(int index) {
  const auto level = [](int bits) { return (bits & 31) * 8 + 3.5; };
  return ToHsv(level(index >> 10), level(index >> 5), level(index));
}

double HueDistanceDeg(double a, double b) { return std::abs(std::remainder(a - b, 360.0)); }

int BinOf(const Hsv& hsv) {
  if (hsv.value < 0.08 || hsv.saturation < 0.1) return 0;
  const int hue = std::min(15, static_cast<int>(hsv.hue_deg / 22.5));
  const int saturation = std::min(3, static_cast<int>(hsv.saturation * 4));
  return hue * 4 + saturation;
}

// BGR weights that sum to zero, positive along `hue_deg`, largest one 1.
Eigen::Vector3f ChromaOfHue(double hue_deg) {
  const double h = hue_deg * std::numbers::pi / 180, third = 2 * std::numbers::pi / 3;
  Eigen::Vector3f weights(static_cast<float>(std::cos(h - 2 * third)),
                          static_cast<float>(std::cos(h - third)), static_cast<float>(std::cos(h)));
  return weights / weights.maxCoeff();
}

}  // namespace

double HueDeg(const Eigen::Vector3d& rgb) { return ToHsv(rgb.z(), rgb.y(), rgb.x()).hue_deg; }

double Bhattacharyya(const Histogram& a, const Histogram& b) {
  double sum = 0;
  for (int i = 0; i < kHistogramBins; ++i) sum += std::sqrt(a[i] * b[i]);
  return sum;
}

MarkerColour MakeMarkerColour(const MarkerColourOptions& options) {
  MarkerColour colour;
  colour.hue_deg = options.hue_deg.value_or(120);
  colour.chroma = ChromaOfHue(colour.hue_deg);
  colour.bin.resize(MarkerColour::kTableSize);
  colour.likelihood.resize(MarkerColour::kTableSize);
  for (int i = 0; i < MarkerColour::kTableSize; ++i) {
    const Hsv hsv = EntryHsv(i);
    const bool inside = HueDistanceDeg(hsv.hue_deg, colour.hue_deg) < options.hue_tolerance_deg &&
                        hsv.saturation > options.min_saturation && hsv.value > options.min_value;
    colour.bin[i] = static_cast<std::uint8_t>(BinOf(hsv));
    colour.likelihood[i] = inside ? 255 : 0;
  }
  FuseTables(colour);
  return colour;
}

void FuseTables(MarkerColour& colour) {
  colour.both.resize(MarkerColour::kTableSize);
  for (int i = 0; i < MarkerColour::kTableSize; ++i) {
    colour.both[i] = static_cast<std::uint16_t>(colour.likelihood[i] << 8 | colour.bin[i]);
  }
}

void LearnMarkerColour(const cv::Mat& bgr, const cv::Mat& mask, MarkerColour& colour) {
  // Counts start at a little prior of the gate, so that shades not yet seen stay possible.
  std::array<double, kHistogramBins> caps = {}, rest = {};
  double sum_x = 0, sum_y = 0;
  for (int v = 0; v < bgr.rows; ++v) {
    const std::uint8_t* pixel = bgr.ptr(v);
    const std::uint8_t* inside = mask.ptr(v);
    for (int u = 0; u < bgr.cols; ++u, pixel += 3) {
      const int index = MarkerColour::Index(pixel);
      (inside[u] ? caps : rest)[colour.bin[index]] += 1;
      if (!inside[u] || colour.likelihood[index] == 0) continue;
      const Hsv hsv = ToHsv(pixel[0], pixel[1], pixel[2]);
      const double h = hsv.hue_deg * std::numbers::pi / 180;
      sum_x += hsv.saturation * std::cos(h);
      sum_y += hsv.saturation * std::sin(h);
    }
  }
  double total_caps = 1e-9, total_rest = 1e-9;
  for (int i = 0; i < kHistogramBins; ++i) total_caps += caps[i], total_rest += rest[i];
  for (int i = 0; i < kHistogramBins; ++i) {
    colour.model[i] = static_cast<float>(caps[i] / total_caps);
  }
  if (sum_x != 0 || sum_y != 0) {
    colour.hue_deg = std::fmod(std::atan2(sum_y, sum_x) * 180 / std::numbers::pi + 360, 360.0);
    colour.chroma = ChromaOfHue(colour.hue_deg);
  }
  for (int i = 0; i < MarkerColour::kTableSize; ++i) {
    const int bin = colour.bin[i];
    const double p_cap = caps[bin] / total_caps, p_rest = rest[bin] / total_rest;
    const double posterior = p_cap / (p_cap + p_rest + 1e-4);
    // A gated colour whose bin was not seen keeps a doubt of one half.
    const double gate = colour.likelihood[i] > 0 ? 1 : 0;
    colour.likelihood[i] = static_cast<std::uint8_t>(
        std::lround(255 * gate * (caps[bin] + rest[bin] > 0 ? posterior : 0.5)));
  }
  FuseTables(colour);
}

std::optional<double> FindMarkerHue(const cv::Mat& bgr, MarkerColourOptions options) {
  constexpr int kHues = 24;  // gates every 15 degrees
  cv::Mat likelihood(bgr.size(), CV_8UC1), bins(bgr.size(), CV_8UC1);
  std::optional<double> best;
  double best_score = 0.25;  // below: no hue looks like five caps
  for (int i = 0; i < kHues; ++i) {
    options.hue_deg = i * 360.0 / kHues;
    options.hue_tolerance_deg = 20;
    options.min_saturation = std::max(options.min_saturation, 0.5);
    MapColours(bgr, MakeMarkerColour(options), {0, 0, bgr.cols, bgr.rows}, likelihood, bins);
    const std::vector<MarkerBlob> blobs = SegmentMarkers(likelihood, 25);
    if (blobs.size() < 5 || blobs.size() > 9) continue;
    // Five regions of similar size, compact, small against the picture.
    const double ratio = blobs[4].area / blobs[0].area;
    const double share = blobs[0].area / static_cast<double>(bgr.total());
    double fill = 1;
    for (int k = 0; k < 5; ++k) {
      const double side = std::max(blobs[k].box.width, blobs[k].box.height);
      fill = std::min(fill, blobs[k].area / (side * side));
    }
    const double score = share > 0.02 ? 0 : ratio * fill * 5.0 / static_cast<double>(blobs.size());
    if (score > best_score) {
      best_score = score;
      best = options.hue_deg;
    }
  }
  return best;
}

void MapColours(const cv::Mat& bgr, const MarkerColour& colour, const cv::Rect& region,
                cv::Mat& likelihood, cv::Mat& bins) {
  for (int v = region.y; v < region.y + region.height; ++v) {
    const std::uint8_t* pixel = bgr.ptr(v) + 3 * region.x;
    std::uint8_t* l = likelihood.ptr(v);
    std::uint8_t* b = bins.ptr(v);
    for (int u = region.x; u < region.x + region.width; ++u, pixel += 3) {
      const std::uint16_t both = colour.both[MarkerColour::Index(pixel)];
      l[u] = static_cast<std::uint8_t>(both >> 8);
      b[u] = static_cast<std::uint8_t>(both);
    }
  }
}

}  // namespace springgrasp
