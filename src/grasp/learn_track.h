// A demonstration made even and smooth: the hand's pose, and the fingertips seen from the hand.
#pragma once

#include <optional>
#include <vector>

#include "base/fingers.h"
#include "base/pose.h"
#include "demonstration/demonstration.h"
#include "grasp/generate_fingers.h"

namespace springgrasp {

struct HandTrack {
  double dt = 0.01;          // s
  double t0 = 0;             // s, the recording's time of the first step
  bool wrist = false;        // else H's origin is the thumb-index midpoint
  bool orientation = false;  // else H's axes are the world's
  std::vector<Pose> X_WH;
  std::vector<Fingertips> p_HF;  // gaps bridged in H, where fingers move least
  // As measured, at the recording's own times (s, from t0), seen from the smoothed hand.
  std::vector<double> sample_t;
  std::vector<PerFinger<std::optional<Eigen::Vector3d>>> sample_p_HF;
  PerFinger<bool> observed = {};  // seen often enough to learn from
  double tip_noise = 0;           // deviation of a measured tip coordinate, m
  double hand_noise = 0;          // the same of the wrist, m

  int size() const { return static_cast<int>(X_WH.size()); }
};

// Smoothed by the measured noise and rate, the hand at `most_hand_cutoff` (Hz) at most. Throws
// Error if too little was seen: neither a wrist nor thumb and index finger, or no thumb, or no
// finger beside it.
HandTrack MakeHandTrack(const Demonstration& demonstration, double most_hand_cutoff = 1e3);

// The same hand with another frame H' fixed to it: X_WH' = X_WH X_HH', tips moved along.
HandTrack WithHandFrame(const HandTrack& track, const Pose& X_HHnew);

// Speed of H's origin, m/s, and distance between thumb and the mean of the other involved and
// observed tips, m, at every step.
std::vector<double> HandSpeed(const HandTrack& track);
std::vector<double> ThumbFingerSpan(const HandTrack& track, const PerFinger<bool>& involved);

}  // namespace springgrasp
