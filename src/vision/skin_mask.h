// The hand's skin in a picture: learned in the first frame from what surrounds the caps, against
// what is far from them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "vision/marker_colour.h"
#include "vision/white_balance.h"

namespace springgrasp {

// Likelihood 0..255 of skin over the shares of red and green; brightness is left out. Asked for by
// a table of colours with six bits per channel, since the shares need divisions.
struct SkinModel {
  static constexpr int kSide = 64;
  std::array<std::uint8_t, kSide* kSide> likelihood = {};
  std::vector<std::uint8_t> table;  // [2^18], of `likelihood`; empty: no colour is skin
  std::uint8_t Of(std::uint8_t b, std::uint8_t g, std::uint8_t r) const {
    return table.empty() ? std::uint8_t{0} : table[(b >> 2) << 12 | (g >> 2) << 6 | r >> 2];
  }
};

// Skin among the pixels within 2.5 cap radii of the caps (a wide gate says which),
// likelihood against the pixels farther than sixteen.
SkinModel LearnSkin(const cv::Mat& bgr, const MarkerColour& caps,
                    const std::vector<Eigen::Vector2d>& cap_px, double cap_radius_px);

// Which way the finger leaves its cap in the picture: mean direction (unit vectors) of the skin in
// a ring of 1.3 to 2.3 cap radii about it. Short (< 0.2) when skin is all around or nowhere.
Eigen::Vector2d SkinDirection(const cv::Mat& bgr, const SkinModel& skin,
                              const Eigen::Vector2d& cap_px, double cap_radius_px);

// A mask at reduced resolution: entry (i, j) stands for picture pixel
// (region.x + j * step, region.y + i * step).
struct HandMask {
  cv::Mat mask;  // CV_8UC1, 255 skin or cap, 0 elsewhere
  cv::Rect region;
  int step = 2;
  Eigen::Vector2d ToMask(const Eigen::Vector2d& pixel) const;
  Eigen::Vector2d ToPixel(const Eigen::Vector2d& entry) const;
};

// Whether a pixel is skin or cap.
bool OnSkin(const HandMask& hand, const Eigen::Vector2d& pixel);

// Skin and caps within `region`, only the parts connected to a cap or under one of `hand_px`, where
// the hand is otherwise known to be. `levels` turn the picture's
// colours to those that the skin was learned in. Reuses the memory of `hand`.
void SegmentHand(const cv::Mat& bgr, const LevelTable& levels, const SkinModel& skin,
                 const MarkerColour& caps, const std::vector<Eigen::Vector2d>& cap_px,
                 double cap_radius_px, const std::vector<Eigen::Vector2d>& hand_px,
                 const cv::Rect& region, int step, HandMask& hand);

// Centre of the largest disc inside the mask that is not farther from the middle of the caps than
// `reach_px`, if possible about equally far from all of them: the palm. Nothing if no disc is wider
// than a finger (1.3 cap radii).
std::optional<Eigen::Vector2d> PalmCentre(const HandMask& hand,
                                          const std::vector<Eigen::Vector2d>& cap_px,
                                          double cap_radius_px, double reach_px);

}  // namespace springgrasp
