// Refinement of regions to the modes of a likelihood picture (Comaniciu and Meer 2002), for all
// fingers at once: caps of one colour must not climb the same hill.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "base/fingers.h"

namespace springgrasp {

struct MeanShiftResult {
  PerFinger<Eigen::Vector2d> centre;  // px; unchanged where no likelihood was found
  PerFinger<double> mass = {};        // sum of likelihood (0..1 per pixel) in the window, px
  int iterations = 0;
};

// Moves each active region to the likelihood-weighted mean of the pixels within `radius_px` of its
// centre, again and again until none moves more than `tolerance_px`. A pixel within reach of
// several regions counts for the nearest only, measured in their radii. `likelihood`: CV_8UC1,
// valid in and around the regions; windows are cut at the picture's border.
MeanShiftResult MeanShift(const cv::Mat& likelihood, const PerFinger<Eigen::Vector2d>& start,
                          const PerFinger<bool>& active, const PerFinger<double>& radius_px,
                          int max_iterations = 12, double tolerance_px = 0.05);

}  // namespace springgrasp
