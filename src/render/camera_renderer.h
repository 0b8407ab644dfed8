// Pictures of a model through its cameras: colour, depth, segmentation.
#pragma once

#include <mujoco/mujoco.h>

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/pose.h"

namespace springgrasp {

struct RenderOptions {
  int width = 640;
  int height = 480;
  bool shadows = false;  // pretty: for videos; three times slower
  bool reflections = false;
  int shadow_size = 1024;                                              // of the shadow map
  std::vector<bool> groups = {true, true, true, false, false, false};  // geom groups drawn
  // Pretty: shadows on. Build the model with offscreen_samples = 4 for smooth edges.
  static RenderOptions Pretty(int width = 800, int height = 600);
};

// A named camera of the model, or a free one (name empty).
struct CameraView {
  std::string name;
  Pose X_WC = Pose::Identity();  // OpenCV convention; used when name is empty
  double fovy_deg = 45;          // likewise
  static CameraView Named(std::string name) { return {std::move(name), Pose::Identity(), 45}; }
  static CameraView Free(const Pose& X_WC, double fovy_deg) { return {"", X_WC, fovy_deg}; }
};

// A sphere or line drawn into a picture on top of the model (planned tips, contact forces).
struct Mark {
  enum class Kind { kSphere, kArrow };
  Kind kind = Kind::kSphere;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();   // centre, or tail of the arrow
  Eigen::Vector3d to_W = Eigen::Vector3d::Zero();  // head of the arrow
  double radius = 0.005;                           // m
  Eigen::Vector4d rgba{1, 0, 0, 1};
};

// Bound to one model, which must outlive it; holds what MuJoCo uploads to the GPU. Not copyable,
// cheap to keep, costs some ten milliseconds to make. Needs data after mj_kinematics, mj_comPos
// and mj_camlight (Simulation::Forward or Step).
class CameraRenderer {
 public:
  explicit CameraRenderer(const mjModel& model, RenderOptions options = {});
  ~CameraRenderer();

  // CV_8UC3, BGR, first row on top. The header is fresh, the pixels are the caller's.
  cv::Mat Bgr(const mjData& data, const CameraView& view, const std::vector<Mark>& marks = {});
  // CV_32FC1: distance along the optical axis in metres; the far plane where nothing is.
  cv::Mat Depth(const mjData& data, const CameraView& view);
  // CV_32SC1: geom id of each pixel, -1 for none.
  cv::Mat Segmentation(const mjData& data, const CameraView& view);

  // Pixels of each of `geoms` (by id): seen, and as it would be were nothing else there (cut by
  // the picture's border only). Their ratio is the visible fraction.
  struct Visibility {
    int visible = 0;
    int unoccluded = 0;
    double fraction() const { return unoccluded > 0 ? double(visible) / unoccluded : 0; }
  };
  std::vector<Visibility> CountVisible(const mjData& data, const CameraView& view,
                                       const std::vector<int>& geoms);

  const RenderOptions& options() const { return options_; }

 private:
  struct Impl;
  RenderOptions options_;
  std::unique_ptr<Impl> impl_;
};

// One picture of the whole model, from a view that holds it or by a camera, at the named keyframe
// (empty: the first, or all zero). Throws Error for unknown names.
cv::Mat PictureOf(const mjModel& model, int width = 960, int height = 720,
                  const std::string& camera = "", const std::string& keyframe = "");

}  // namespace springgrasp
