// Where before the robot's eyes a demonstration is performed: system contract 5.1.
#pragma once

#include "base/pose.h"
#include "demonstration/hand_motion.h"
#include "experiment/demonstrator_hand.h"
#include "vision/camera_model.h"

namespace springgrasp {

struct DisplayOptions {
  double near = 0.5, far = 0.7;  // m, of the path's middle before the eyes
  double margin_px = 15;         // of every fingertip and knuckle from the picture's border
  // Recordings may be turned in any direction (their `up` is told in the CSV); a demonstration
  // with an upright object only about the vertical.
  bool upright = true;
};

struct DisplayPlacement {
  Pose X_WM = Pose::Identity();  // of the motion's own frame
  double visible = 0;            // estimated part of (involved tip, instant) seen by both eyes
  double margin_px = 0;          // smallest distance from a border
  double palm_deg = 0;           // mean angle between palm normal and the direction to the eyes
};

// Searches turns and distances; deterministic. Always returns the best: judge it by the fields.
DisplayPlacement PlaceInDisplay(const DemonstratorHand& hand, const HandMotion& motion,
                                const StereoCameras& eyes, const DisplayOptions& options = {});

}  // namespace springgrasp
