// How two eyes see the hand of test_hand.h: as masks, and as pictures.
#pragma once

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "vision/hand_pose.h"
#include "vision/stereo_frame.h"
#include "vision/synthetic_caps.h"
#include "vision/test_hand.h"

namespace springgrasp {

// Masks of the model's balls in both pictures, and its fingertips.
struct Seen {
  HandMask masks[2];
  HandObservation observation;
};

inline void See(const HandModel& model, const HandFit& truth, const StereoCameras& eyes,
                Seen& seen) {
  std::vector<Pose> X_HB;
  ForwardKinematics(model.tree, truth.q, X_HB);
  for (int v = 0; v < 2; ++v) {
    const CameraModel& camera = eyes.view(v);
    cv::Mat picture = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
    for (const HandBall& ball : model.balls) {
      const Eigen::Vector3d p_W = truth.X_WH * (X_HB[ball.node] * ball.p_B);
      const Eigen::Vector2d pixel = *Project(camera, p_W);
      const double depth = (camera.X_WC.inverse() * p_W).z();
      cv::circle(
          picture,
          {static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y()))},
          static_cast<int>(std::lround(camera.fx * ball.radius / depth)), 255, cv::FILLED);
    }
    seen.masks[v].region = {0, 0, camera.width, camera.height};
    seen.masks[v].step = 2;
    cv::resize(picture, seen.masks[v].mask, {camera.width / 2, camera.height / 2}, 0, 0,
               cv::INTER_NEAREST);
    seen.observation.masks[v] = &seen.masks[v];
  }
  for (int f = 0; f < kNumFingers; ++f) {
    seen.observation.tip_W[f] = FittedTip(model, truth, f);
    seen.observation.confidence[f] = 1;
  }
}

// Palm to the cameras, fingers up, at 0.6 m.
inline HandFit OpenHand(const HandModel& model) {
  HandFit truth;
  truth.q = (0.8 * model.rest).cwiseMax(model.tree.lower).cwiseMin(model.tree.upper);
  truth.X_WH.linear() << 0.1, 1, 0, -1, 0.1, 0, 0, 0, 1;
  truth.X_WH.linear().col(0).normalize();
  truth.X_WH.linear().col(1) = truth.X_WH.linear().col(2).cross(truth.X_WH.linear().col(0));
  truth.X_WH.linear() =
      Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitX()).toRotationMatrix() * truth.X_WH.linear();
  truth.X_WH.translation() = Eigen::Vector3d(0.05, 0.1, 0.62);
  return truth;
}

// The model's own hand, palm to the eyes, as pictures with caps and skin.
struct Shown {
  StereoFrame frame;
  PerFinger<Eigen::Vector3d> tips;
};

inline Shown Show(const StereoCameras& eyes, const std::vector<DrawnCapsule>& others = {},
                  const Eigen::Vector3d& wrist_W = {0.03, 0.1, 0.6}) {
  const HandModel model = MakeHandModel(TestHand());
  HandFit hand;
  hand.q = model.rest;
  // Fingers up in the picture, z of H away from the eyes.
  hand.X_WH.linear().col(0) = -Eigen::Vector3d::UnitY();
  hand.X_WH.linear().col(1) = Eigen::Vector3d::UnitX();
  hand.X_WH.linear().col(2) = Eigen::Vector3d::UnitZ();
  hand.X_WH.translation() = wrist_W;
  const Eigen::Vector3d palm = PalmOf(hand), wrist = hand.X_WH.translation();
  std::vector<DrawnCapsule> scene = others;
  Shown shown;
  for (int f = 0; f < kNumFingers; ++f) {
    const Eigen::Vector3d tip = shown.tips[f] = FittedTip(model, hand, f);
    const Eigen::Vector3d axis = FittedAxis(model, hand, f);
    const double half = 0.5 * kCapLength - kCapRadius;
    scene.push_back({tip - half * axis, tip + half * axis, kCapRadius, {20, 160, 20}});
    scene.push_back({tip - 0.004 * axis, tip - 0.035 * axis, 0.0078, kSkin});
    scene.push_back({tip - 0.035 * axis, palm, 0.0085, kSkin});
  }
  scene.push_back({palm, wrist, 0.033, kSkin});
  scene.push_back({wrist, wrist + Eigen::Vector3d(0, 0.2, 0), 0.026, kSkin});
  shown.frame.left = DrawCapsules(eyes.left, scene);
  shown.frame.right = DrawCapsules(eyes.right, scene);
  return shown;
}

}  // namespace springgrasp
