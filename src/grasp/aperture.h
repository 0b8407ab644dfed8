// How far a hand is open, and how well it lands: what people's grasps are judged by.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "base/fingers.h"
#include "grasp/fingertip_motion.h"

namespace springgrasp {

// Distance between the thumb and the mean of the other involved tips, m.
double Aperture(const PerFinger<Eigen::Vector3d>& p_H, const PerFinger<bool>& involved);

// When a hand is widest, in steps of `p_H`: the middle of the steps around `widest` at which it is
// as wide to 1 mm, which is what a tip is known to. Hands stay wide for a tenth of the reach.
double WidestStep(const std::vector<PerFinger<Eigen::Vector3d>>& p_H,
                  const PerFinger<bool>& involved, std::size_t widest);

struct WidestAperture {
  double start = 0;   // m, of the first sample
  double widest = 0;  // m
  double at = 0;      // of T
};
WidestAperture FindWidestAperture(const FingertipMotion& motion);

// Largest distance of an involved tip from its contact in the samples from `from` to `to`, s; m.
double ContactError(const FingertipMotion& motion, double from, double to);

}  // namespace springgrasp
