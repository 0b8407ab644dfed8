// Where the centre of a whole cap is, given the outlines seen of it. The centroid of what is seen
// is not it: a cap is long along its finger and its back end is often hidden. So the cap is a
// capsule, whose projected outline is laid through the outlines of both pictures at once.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <opencv2/core.hpp>
#include <optional>

#include "vision/camera_model.h"
#include "vision/marker_colour.h"

namespace springgrasp {

// A cap: all points within `radius` of a segment along the finger.
struct CapShape {
  double radius = 0;     // m; 0: found in the first frames
  double length = 0;     // m, end to end (2 radius: a sphere); 0: 2.5 radius, a thimble's
  double to_centre = 0;  // m, from the tip's end to the point that is tracked; 0: as the next says
  bool to_sphere = false;  // true: centre of the sphere at the tip's end; false: the middle
  double full_length() const { return length > 0 ? std::max(length, 2 * radius) : 2.5 * radius; }
  double centre_from_tip() const {
    return to_centre > 0 ? to_centre : to_sphere ? radius : 0.5 * full_length();
  }
  // Ends of the segment along the axis, from the tracked point: behind it and before it, m.
  double back() const { return centre_from_tip() - full_length() + radius; }
  double front() const { return centre_from_tip() - radius; }
};

inline constexpr int kContourRays = 24;

// Outline of a cap in one picture: where rays from inside leave the cap's colour, finer than a
// pixel (position at which a mixed pixel is half cap, half surroundings).
struct CapContour {
  std::array<Eigen::Vector2d, kContourRays> point;
  std::array<bool, kContourRays> valid = {};
  int count = 0;  // valid points
};

// `inside`: a pixel well within the cap; rays end at `reach_px`, and those that met no edge by
// then (a neighbouring cap, the picture's border) are not valid.
CapContour TraceCap(const cv::Mat& bgr, const MarkerColour& colour, const Eigen::Vector2d& inside,
                    double reach_px);

struct CapFit {
  Eigen::Vector3d p_W;                   // centre of the whole cap, m
  Eigen::Vector3d axis_W;                // unit, towards the fingertip
  double rms_px = 0;                     // of the points that agree with the outline
  std::array<double, 2> agreement = {};  // share of all rays that agree, per view
  double radius = 0;                     // m, that the agreeing points would like best
};

struct CapFitOptions {
  double axis_prior = 0.5;  // weight of the expected axis: px of outline per radian
  double inlier_px = 1.0;   // scale of the robust weight (Geman-McClure) outside the outline
  double hidden_px = 0.7;   // the same inside it: the edge of whatever hides the cap
  int iterations = 6;
};

// Gauss-Newton on the distances of the outline points from the projected capsule's outline, in
// both views. The radius is taken as known; the apparent size does not pull the depth. Nothing if
// fewer than 6 points agree in either view or the result is behind a camera.
std::optional<CapFit> FitCap(const StereoCameras& cameras,
                             const std::array<CapContour, 2>& contours, const CapShape& shape,
                             const Eigen::Vector3d& start_W, const Eigen::Vector3d& axis_W,
                             const CapFitOptions& options = {});

}  // namespace springgrasp
