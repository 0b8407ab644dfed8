#include "vision/skin_mask.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace springgrasp {
namespace {

// Shares of red and green in the brightness, in steps of 1/128 from 1/4 and 1/8: shading leaves
// them alone, which it does not do to differences as Cr and Cb.
int ChromaBin(int b, int g, int r) {
  const int sum = std::max(1, b + g + r);
  const int red = std::clamp(128 * r / sum - 32, 0, SkinModel::kSide - 1);
  const int green = std::clamp(128 * g / sum - 16, 0, SkinModel::kSide - 1);
  return red * SkinModel::kSide + green;
}

// The wide gate of skin in shares of red and green (after Soriano et al. 2003), not nearly black.
bool MayBeSkin(int b, int g, int r) {
  const double sum = std::max(1, b + g + r), red = r / sum, green = g / sum;
  return sum > 75 && red > 0.35 && red < 0.62 && green > 0.2 && green < 0.37 && r > g;
}

}  // namespace

SkinModel LearnSkin(const cv::Mat& bgr, const MarkerColour& caps,
                    const std::vector<Eigen::Vector2d>& cap_px, double cap_radius_px) {
  constexpr int kBins = SkinModel::kSide * SkinModel::kSide;
  std::vector<float> near(kBins, 0.0F), far(kBins, 0.0F);
  float total_near = 1e-6F, total_far = 1e-6F;
  for (int v = 0; v < bgr.rows; v += 2) {
    for (int u = 0; u < bgr.cols; u += 2) {
      double distance = 1e9;
      for (const auto& cap : cap_px) {
        distance = std::min(distance, std::hypot(u - cap.x(), v - cap.y()));
      }
      const std::uint8_t* pixel = bgr.ptr(v) + 3 * u;
      const int bin = ChromaBin(pixel[0], pixel[1], pixel[2]);
      if (distance > 16 * cap_radius_px) {
        far[bin] += 1;
        total_far += 1;
      } else if (distance < 2.5 * cap_radius_px &&
                 caps.likelihood[MarkerColour::Index(pixel)] < 64 &&
                 MayBeSkin(pixel[0], pixel[1], pixel[2])) {
        near[bin] += 1;
        total_near += 1;
      }
    }
  }
  cv::Mat near_map(SkinModel::kSide, SkinModel::kSide, CV_32F, near.data());
  cv::Mat far_map(SkinModel::kSide, SkinModel::kSide, CV_32F, far.data());
  cv::GaussianBlur(near_map, near_map, {5, 5}, 1.0);
  cv::GaussianBlur(far_map, far_map, {3, 3}, 0.6);
  SkinModel skin;
  for (int i = 0; i < kBins; ++i) {
    const float p_near = near[i] / total_near, p_far = far[i] / total_far;
    skin.likelihood[i] = static_cast<std::uint8_t>(255 * p_near / (p_near + p_far + 2e-4F));
  }
  skin.table.resize(1 << 18);
  for (int i = 0; i < 1 << 18; ++i) {
    const auto level = [](int bits) { return 4 * (bits & 63) + 2; };
    const int b = level(i >> 12), g = level(i >> 6), r = level(i);
    skin.table[static_cast<std::size_t>(i)] =
        b + g + r > 60 ? skin.likelihood[ChromaBin(b, g, r)] : std::uint8_t{0};
  }
  return skin;
}

Eigen::Vector2d SkinDirection(const cv::Mat& bgr, const SkinModel& skin,
                              const Eigen::Vector2d& cap_px, double cap_radius_px) {
  constexpr int kDirections = 24;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double total = 0;
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2 * std::numbers::pi * k / kDirections;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    for (const double radii : {1.3, 1.6, 1.95, 2.3}) {
      const Eigen::Vector2d at = cap_px + radii * cap_radius_px * direction;
      const int u = static_cast<int>(std::lround(at.x())),
                v = static_cast<int>(std::lround(at.y()));
      if (u < 0 || v < 0 || u >= bgr.cols || v >= bgr.rows) continue;
      const std::uint8_t* pixel = bgr.ptr(v) + 3 * u;
      const double weight = skin.Of(pixel[0], pixel[1], pixel[2]) / 255.0;
      sum += weight * direction;
      total += weight;
    }
  }
  return total > 4 ? Eigen::Vector2d(sum / total) : Eigen::Vector2d::Zero();
}

Eigen::Vector2d HandMask::ToMask(const Eigen::Vector2d& pixel) const {
  return (pixel - Eigen::Vector2d(region.x, region.y)) / step;
}

Eigen::Vector2d HandMask::ToPixel(const Eigen::Vector2d& entry) const {
  return entry * step + Eigen::Vector2d(region.x, region.y);
}

void SegmentHand(const cv::Mat& bgr, const LevelTable& levels, const SkinModel& skin,
                 const MarkerColour& caps, const std::vector<Eigen::Vector2d>& cap_px,
                 double cap_radius_px, const std::vector<Eigen::Vector2d>& hand_px,
                 const cv::Rect& region, int step, HandMask& hand) {
  hand.region = region;
  hand.step = step;
  const int rows = (region.height + step - 1) / step, cols = (region.width + step - 1) / step;
  hand.mask.create(rows, cols, CV_8UC1);
  for (int i = 0; i < rows; ++i) {
    const std::uint8_t* pixel = bgr.ptr(region.y + i * step) + 3 * region.x;
    std::uint8_t* out = hand.mask.ptr(i);
    for (int j = 0; j < cols; ++j, pixel += 3 * step) {
      const bool cap = caps.likelihood[MarkerColour::Index(pixel)] > 127;
      out[j] = cap ? 255 : skin.Of(levels[0][pixel[0]], levels[1][pixel[1]], levels[2][pixel[2]]);
    }
  }
  // Noise of single pixels is not the hand's outline.
  cv::blur(hand.mask, hand.mask, {3, 3});
  cv::threshold(hand.mask, hand.mask, 127, 255, cv::THRESH_BINARY);
  const cv::Mat kernel = cv::getStructuringElement(cv::MORPH_ELLIPSE, {3, 3});
  cv::morphologyEx(hand.mask, hand.mask, cv::MORPH_OPEN, kernel);
  // Keep what touches a cap or is known to be the hand.
  cv::Mat labels;
  const int count = cv::connectedComponents(hand.mask, labels, 8, CV_32S);
  std::vector<std::uint8_t> keep(count, 0);
  const int reach = std::max(1, static_cast<int>(std::lround(1.5 * cap_radius_px / step)));
  for (const auto& cap : cap_px) {
    const Eigen::Vector2d c = hand.ToMask(cap);
    for (int i = std::max(0, static_cast<int>(c.y()) - reach);
         i <= std::min(rows - 1, static_cast<int>(c.y()) + reach); ++i) {
      for (int j = std::max(0, static_cast<int>(c.x()) - reach);
           j <= std::min(cols - 1, static_cast<int>(c.x()) + reach); ++j) {
        keep[labels.at<int>(i, j)] = 1;
      }
    }
  }
  for (const auto& pixel : hand_px) {
    const Eigen::Vector2d at = hand.ToMask(pixel);
    const int j = static_cast<int>(std::lround(at.x())), i = static_cast<int>(std::lround(at.y()));
    if (i >= 0 && j >= 0 && i < rows && j < cols) keep[labels.at<int>(i, j)] = 1;
  }
  keep[0] = 0;
  for (int i = 0; i < rows; ++i) {
    std::uint8_t* out = hand.mask.ptr(i);
    const int* label = labels.ptr<int>(i);
    for (int j = 0; j < cols; ++j) out[j] = keep[label[j]] ? 255 : 0;
  }
}

bool OnSkin(const HandMask& hand, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d at = hand.ToMask(pixel);
  const int j = static_cast<int>(std::lround(at.x())), i = static_cast<int>(std::lround(at.y()));
  if (i < 0 || j < 0 || i >= hand.mask.rows || j >= hand.mask.cols) return false;
  return hand.mask.at<std::uint8_t>(i, j) > 0;
}

std::optional<Eigen::Vector2d> PalmCentre(const HandMask& hand,
                                          const std::vector<Eigen::Vector2d>& cap_px,
                                          double cap_radius_px, double reach_px) {
  if (hand.mask.empty() || cap_px.empty()) return std::nullopt;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& cap : cap_px) middle += cap / static_cast<double>(cap_px.size());
  cv::Mat distance;
  cv::distanceTransform(hand.mask, distance, cv::DIST_L2, 3);
  // The caps of an open hand are about equally far from its palm; other things of skin's colour may
  // be wider, but they lie beside the hand. A closed hand has no such place: then the widest of
  // all.
  const auto among_caps = [&](const Eigen::Vector2d& pixel) {
    double nearest = 1e9, farthest = 0;
    for (const auto& cap : cap_px) {
      const double d = (pixel - cap).norm();
      nearest = std::min(nearest, d);
      farthest = std::max(farthest, d);
    }
    return nearest > 0.45 * farthest && nearest > 3.5 * cap_radius_px;
  };
  for (const bool open : {true, false}) {
    std::optional<Eigen::Vector2d> best;
    double widest = 1.3 * cap_radius_px / hand.step;
    for (int i = 0; i < distance.rows; ++i) {
      const float* row = distance.ptr<float>(i);
      for (int j = 0; j < distance.cols; ++j) {
        if (row[j] <= widest) continue;
        const Eigen::Vector2d pixel =
            hand.ToPixel({static_cast<double>(j), static_cast<double>(i)});
        if ((pixel - middle).norm() > reach_px || (open && !among_caps(pixel))) continue;
        widest = row[j];
        best = pixel;
      }
    }
    if (best) return best;
  }
  return std::nullopt;
}

}  // namespace springgrasp
