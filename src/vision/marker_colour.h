// What the caps look like: HSV histograms for the particle weights, a back-projection likelihood
// for mean shift, and the share of cap in a mixed pixel for positions finer than a pixel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace springgrasp {

// Colours that may be cap before anything was seen. Green by default (the paper's caps).
struct MarkerColourOptions {
  std::optional<double> hue_deg = 120;  // 0 red, 120 green, 240 blue; absent: found in the picture
  double hue_tolerance_deg = 35;        // either side
  double min_saturation = 0.35;         // 0..1
  double min_value = 0.12;              // 0..1
};

// Histogram over hue (16) x saturation (4); pixels too dark for a hue fall into bin 0. Value is
// left out: it is what shading and lamps change.
inline constexpr int kHistogramBins = 64;
using Histogram = std::array<float, kHistogramBins>;  // sums to 1

// Similarity of two histograms in [0, 1]: Bhattacharyya coefficient.
double Bhattacharyya(const Histogram& a, const Histogram& b);

// Everything the tracker asks of a pixel's colour, as one table look-up on 5 bits per channel.
struct MarkerColour {
  static constexpr int kTableSize = 1 << 15;
  std::vector<std::uint8_t> bin;         // [kTableSize] histogram bin
  std::vector<std::uint8_t> likelihood;  // [kTableSize] back-projection of the cap model, 0..255
  std::vector<std::uint16_t> both;       // [kTableSize] likelihood << 8 | bin, for MapColours
  Histogram model = {};                  // of the caps in the first frame
  Eigen::Vector3f chroma = {-0.5F, 1.0F, -0.5F};  // BGR weights; sum 0: grey of any value gives 0
  double hue_deg = 120;

  static int Index(const std::uint8_t* bgr) {
    return (bgr[0] >> 3) << 10 | (bgr[1] >> 3) << 5 | bgr[2] >> 3;
  }
  // Amount of cap colour in a pixel: linear in the share of cap, 0 for greys.
  float Chroma(const std::uint8_t* bgr) const {
    return chroma[0] * bgr[0] + chroma[1] * bgr[1] + chroma[2] * bgr[2];
  }
};

// Model from the options alone: likelihood is 255 within the gates, 0 elsewhere.
MarkerColour MakeMarkerColour(const MarkerColourOptions& options);

// Learns histogram and back-projection from the pixels of the caps (`mask` nonzero) against those
// around them: likelihood = 255 * P(cap | bin) with equal priors. Mask and picture of equal size.
void LearnMarkerColour(const cv::Mat& bgr, const cv::Mat& mask, MarkerColour& colour);

// Makes `both` of the other two tables, after they were changed.
void FuseTables(MarkerColour& colour);

// Hue of a colour (red, green, blue, any scale), 0 to 360; 0 for greys.
double HueDeg(const Eigen::Vector3d& rgb);

// The hue that most looks like a set of caps: the one whose gate leaves five compact regions of
// similar size. Nothing when no hue does.
std::optional<double> FindMarkerHue(const cv::Mat& bgr, MarkerColourOptions options);

// Fills `likelihood` and `bins` (CV_8UC1, whole picture) within `region` only.
void MapColours(const cv::Mat& bgr, const MarkerColour& colour, const cv::Rect& region,
                cv::Mat& likelihood, cv::Mat& bins);

}  // namespace springgrasp
