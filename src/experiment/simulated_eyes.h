// The robot's eyes as the scene wants them: what they see of a performed motion, frame by frame.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/random.h"
#include "demonstration/hand_motion.h"
#include "experiment/observe_stage.h"
#include "render/camera_effects.h"
#include "sim/scene.h"
#include "vision/track_demonstration.h"

namespace springgrasp {

// An engine of its own for one effect: neither draws from `engine` nor depends on other effects.
RandomEngine SubStream(const RandomEngine& engine, std::string_view name);

// True cameras with the error that a calibration has.
StereoCameras Miscalibrated(const StereoCameras& cameras, const SceneCalibrationError& error,
                            RandomEngine& engine);

class SimulatedEyes {
 public:
  // `motion`: as performed; `shown`: its instants at the eyes' rate. Both, and the stage, must
  // outlive this. Puts the clutter where `engine` says.
  SimulatedEyes(ObserveStage& stage, const SceneEyes& settings, const HandMotion& motion,
                const HandMotion& shown, const RandomEngine& engine);

  // Frames are asked for in order. The first is never dropped: it is the start of time.
  bool IsDropped(std::size_t frame) const { return dropped_[frame]; }
  bool IsCovered(std::size_t frame) const;  // plates are before the occluded caps
  StereoFrame Look(std::size_t frame);
  // Puts the stage as it is at the middle of the frame's exposure.
  void Show(std::size_t frame);
  // What the tracker is told of the cameras.
  const StereoCameras& told() const { return told_; }

 private:
  cv::Mat Exposed(int eye, std::size_t frame);
  int SubframeCount(int eye, double t) const;

  ObserveStage& stage_;
  SceneEyes settings_;
  const HandMotion& motion_;
  const HandMotion& shown_;
  StereoCameras told_;
  RandomEngine noise_engine_;
  PictureNoise noise_;
  double light_phase_ = 0;                                 // turns
  std::array<std::array<double, 3>, 2> white_phase_ = {};  // turns; eye, channel
  std::vector<bool> dropped_;
  std::size_t covered_begin_ = 0, covered_end_ = 0;  // frames with plates
};

}  // namespace springgrasp
