// The display volume before the robot's eyes: robot, demonstrator's hand and its object, placed by
// kinematics alone and seen through the wide-angle pair.
#pragma once

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>

#include "base/random.h"
#include "base/shape.h"
#include "demonstration/hand_motion.h"
#include "experiment/demonstrator_hand.h"
#include "render/camera_effects.h"
#include "render/camera_renderer.h"
#include "sim/scene.h"
#include "sim/simulation.h"
#include "vision/camera_model.h"

namespace springgrasp {

class ObserveStage {
 public:
  // The scene's robot, table and lights; the head looks straight ahead and a little down, the eyes
  // converge on the display volume. `shown` is drawn where Show() puts it.
  ObserveStage(const Scene& scene, const std::optional<Shape>& shown);

  const DemonstratorHand& hand() const { return hand_; }
  // What the tracker is told of hands: the MMM hand as shipped, whoever demonstrates.
  const KinematicTree& common_hand() const { return common_hand_; }
  // Hue of the caps that the demonstrator chose, degrees; absent: the model's green.
  std::optional<double> cap_hue_deg() const { return cap_hue_deg_; }
  const StereoCameras& eyes() const { return eyes_; }          // true, lens included
  const StereoCameras& pinholes() const { return pinholes_; }  // the same without their lens
  const SceneEyes& eyes_settings() const { return settings_; }
  const SceneOcclusion& occlusion() const { return occlusion_; }
  const mjModel& model() const { return simulation_.model(); }
  bool shows_object() const { return object_drawn_; }

  // Puts hand and object as they are at one instant; `covered`: plates before the occluded caps.
  void Show(const HandMotionSample& sample, const std::optional<DemonstratedObject>& object,
            bool covered = false);
  // Puts the clutter on boards behind and beside where the hand moves.
  void ArrangeClutter(const HandMotion& shown, RandomEngine& engine);
  cv::Mat Picture(int eye);  // CV_8UC3, BGR; 0 left, 1 right; behind the lens
  // Part of each cap that is seen by an eye, 0..1.
  PerFinger<double> VisibleCaps(int eye);

 private:
  CameraView View(int eye) const;
  Eigen::Vector3d BetweenEyes() const;
  void PutPlates(bool covered);

  Simulation simulation_;
  DemonstratorHand hand_;
  KinematicTree common_hand_;
  std::optional<double> cap_hue_deg_;
  SceneEyes settings_;
  SceneOcclusion occlusion_;
  int clutter_ = 0;
  StereoCameras eyes_, pinholes_;
  std::optional<LensView> lens_;  // none: a pinhole
  std::unique_ptr<CameraRenderer> renderer_;
  std::vector<int> joint_addresses_;  // of the hand's joints in qpos
  std::vector<int> caps_;             // geom ids
  bool object_drawn_ = false;
};

}  // namespace springgrasp
