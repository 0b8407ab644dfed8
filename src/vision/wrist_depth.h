// How far away the wrist is, by comparing where both pictures show the hand's skin. The fit's
// outlines tell that badly, since they err by the shape of the hand in both views alike: here that
// error falls out.
#pragma once

#include <optional>

#include "vision/camera_model.h"
#include "vision/hand_model.h"

namespace springgrasp {

struct HandFit;
struct HandObservation;

struct WristDepth {
  double depth = 0;  // m, of the origin of H along the left camera's optical axis
  double sigma = 0;  // m
};

// The hand as the fit `about` has it is turned about the middle of its fingertips seen, so that its
// wrist comes nearer or goes farther by up to 60 mm: the left mask of palm and forearm, moved by
// the disparity that each place then has, is laid over the right one, where neither is cut by the
// known object. Nothing without both masks, or if they fit nowhere clearly.
std::optional<WristDepth> MeasureWristDepth(const HandModel& model, const StereoCameras& cameras,
                                            const HandObservation& observation,
                                            const HandFit& about);

}  // namespace springgrasp
