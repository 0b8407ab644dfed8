// Pose of the hand frame H from pictures (system: "Hand motion"): the MMM hand fitted to the skin
// region of both views and to the triangulated fingertips.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "vision/camera_model.h"
#include "vision/hand_model.h"
#include "vision/object_depth.h"
#include "vision/skin_mask.h"

namespace springgrasp {

// Tuned on the four grasps of experiments/tracking, clean and moderate, seeds 31 to 33.
struct HandPoseOptions {
  double tip_sigma = 0.003;          // m, of a fully trusted fingertip
  double ball_sigma_px = 5;          // of a ball outside the mask
  double skin_sigma_px = 4;          // of the mask's outline off that of the balls
  double sleeve_sigma_px = 4;        // of the end of the bare forearm off the mask's edge
  double mask_reach_px = 7;          // beyond, a mask residual says no more: objects hide the hand
  double wrist_depth_sigma = 0.004;  // m, beside that of the measurement
  double wrist_depth_reach = 0.03;   // m; beyond, a measured depth says no more
  double neighbour_sigma = 0.15;     // rad, between the same joint of two neighbouring fingers
  double first_palm_sigma = 0.35;    // of 1 - cosine of palm and line of sight: 50 degrees
  double palm_sigma = 0.4;           // the same after the first frame
  double pose_sigma = 0.009;         // m per frame, about the predicted position
  double turn_sigma = 0.09;          // rad per frame
  double joint_sigma = 0.15;         // rad per frame
  double unseen_sigma = 0.06;        // the same of a finger whose tip is not seen
  double unseen_aside_sigma = 0.01;  // and of its abduction
  double mask_step = 0.2;            // resolution of the masks, in radii of a cap
  int mask_samples = 80;             // on the outline, per view
  int iterations = 8;                // Levenberg-Marquardt, per frame
  int start_iterations = 25;         // of each start in the first frame
};

// What one stereo frame says.
struct HandObservation {
  PerFinger<std::optional<Eigen::Vector3d>> tip_W;  // m
  PerFinger<double> confidence = {};                // 0..1
  std::array<const HandMask*, 2> masks = {nullptr, nullptr};
  const KnownObject* object = nullptr;  // may hide the hand
};

struct HandFit {
  Pose X_WH = Pose::Identity();
  Eigen::VectorXd q;  // finger joints, rad
  double scale = 1;   // of all lengths of the model
  double cost = 0;
  double tip_rms = 0;  // m, over the tips used
  int tips_used = 0;
  int frame = 0;                 // updates since the start
  bool has_orientation = false;  // at least three tips
};

// First frame: the fit from several starts (rigid alignment of the model's tips in some postures
// to those seen), with the scale free. The back of the hand faces away from the cameras. Nothing
// with fewer than four tips.
std::optional<HandFit> StartHandFit(const HandModel& model, const StereoCameras& cameras,
                                    const HandObservation& observation,
                                    const HandPoseOptions& options = {});

// The next frame, from the last one; `moved` is the motion of H expected since: X_WH becomes about
// moved.position further and turned by moved.rotation. With `fit_scale` the scale stays free
// (lead-in), tied to the last one. What tips and masks leave open follows the expectation.
struct HandStep {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, in W
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  // rad, in W
  Eigen::VectorXd joints;                              // rad; empty: none
};
HandFit UpdateHandFit(const HandModel& model, const StereoCameras& cameras,
                      const HandObservation& observation, const HandFit& last,
                      const HandStep& moved, bool fit_scale, const HandPoseOptions& options = {});

// A fit from all over, for a hand whose fit has gone astray: as in the first frame, but with the
// scale of the last fit and a loose hold on its pose. Nothing if none is clearly better.
std::optional<HandFit> RestartHandFit(const HandModel& model, const StereoCameras& cameras,
                                      const HandObservation& observation, const HandFit& last,
                                      const HandPoseOptions& options = {});

// Fingertip and last bone's direction (towards the tip) of a fit, in W: hints for the tracker.
Eigen::Vector3d FittedTip(const HandModel& model, const HandFit& fit, int finger);
Eigen::Vector3d FittedAxis(const HandModel& model, const HandFit& fit, int finger);

// Where a fingertip gets in W by bending the finger as fingers bend, from straighter than it is to
// more bent: places about 10 mm apart. Not for the thumb.
inline constexpr int kArcPlaces = 15;
std::array<Eigen::Vector3d, kArcPlaces> BendingArc(const HandModel& model, const HandFit& fit,
                                                   int finger);

// The palm's middle in W: half way from the wrist to the knuckles.
Eigen::Vector3d PalmOf(const HandFit& fit);

// One instant of the hand's track.
struct HandSample {
  double t = 0;                            // s
  std::optional<Eigen::Vector3d> p_WH;     // m
  std::optional<Eigen::Quaterniond> R_WH;  // unit
};

// Smooths a track by local quadratic regression over +-`half_window` s (Savitzky-Golay on uneven
// samples): positions, and rotation vectors about the window's middle. Missing samples stay
// missing; near them and the ends the window is one-sided.
std::vector<HandSample> SmoothHandTrack(const std::vector<HandSample>& track,
                                        double half_window = 0.1);

}  // namespace springgrasp
