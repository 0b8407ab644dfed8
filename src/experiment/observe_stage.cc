#include "experiment/observe_stage.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "render/camera_geometry.h"
#include "sim/kinematic_tree_of.h"
#include "sim/model_index.h"
#include "sim/scene_builder.h"
#include "vision/marker_colour.h"

namespace springgrasp {
namespace {

constexpr double kGazeDown = 0.2;      // rad, so that head and torso stay out of the picture
constexpr double kGazeDistance = 0.6;  // m, where the eyes converge
constexpr double kHalfBaseline = 0.0465;
const char* const kEyeCameras[2] = {"eye_l_wide", "eye_r_wide"};

ModelPtr BuildStage(Scene scene, const std::optional<Shape>& shown) {
  for (auto& [joint, angle] : scene.start) {
    const std::string subsystem = SubsystemOfJoint(joint);
    if (subsystem == "head" || subsystem == "torso") angle = 0;
  }
  scene.start["eyes_tilt"] = kGazeDown;
  scene.start["eye_l_pan"] = std::atan2(kHalfBaseline, kGazeDistance);
  scene.start["eye_r_pan"] = -std::atan2(kHalfBaseline, kGazeDistance);
  BuildOptions options;
  options.with_objects = false;
  options.with_demonstrator = true;
  options.shown_object = shown;
  return BuildModel(scene, options);
}

std::string CapOf(std::string_view finger) { return "mmm_" + std::string(finger) + "_cap"; }

DemonstratorHand HandOf(const mjModel& m, const Scene& scene) {
  HandSize size{scene.demonstrator.hand_length, 0};
  for (const std::string_view finger : kFingerNames) {
    size.cap_radius =
        std::max(size.cap_radius, m.geom_size[3 * IdOf(m, mjOBJ_GEOM, CapOf(finger))]);
  }
  return MakeDemonstratorHand(KinematicTreeOf(m, "mmm_hand"), size);
}

}  // namespace

ObserveStage::ObserveStage(const Scene& scene, const std::optional<Shape>& shown)
    : simulation_(BuildStage(scene, shown)),
      hand_(HandOf(simulation_.model(), scene)),
      common_hand_(KinematicTreeOf(*LoadModelFile(ModelPath(BuildOptions{}.demonstrator_model)),
                                   "mmm_hand")),
      object_drawn_(shown.has_value()) {
  const mjModel& m = simulation_.model();
  if (scene.demonstrator.cap_colour) cap_hue_deg_ = HueDeg(*scene.demonstrator.cap_colour);
  simulation_.Forward();
  RenderOptions options;
  renderer_ = std::make_unique<CameraRenderer>(m, options);
  for (int eye = 0; eye < 2; ++eye) {
    const Eigen::Matrix3d K =
        PinholeMatrix(CameraFovyDeg(m, kEyeCameras[eye]), options.width, options.height);
    (eye == 0 ? eyes_.left : eyes_.right) = PinholeCamera(
        options.width, options.height, K, CameraPose(m, simulation_.data(), kEyeCameras[eye]));
  }
  for (const std::string& joint : hand_.tree.joint_names) {
    joint_addresses_.push_back(m.jnt_qposadr[IdOf(m, mjOBJ_JOINT, joint)]);
  }
  for (const std::string_view finger : kFingerNames) {
    caps_.push_back(IdOf(m, mjOBJ_GEOM, CapOf(finger)));
  }
}

void ObserveStage::Show(const HandMotionSample& sample,
                        const std::optional<DemonstratedObject>& object) {
  mjData& data = simulation_.mutable_data();
  for (std::size_t j = 0; j < joint_addresses_.size(); ++j) {
    data.qpos[joint_addresses_[j]] = sample.q[static_cast<int>(j)];
  }
  simulation_.PlaceBody("mmm_hand", sample.X_WH);
  if (object && object_drawn_) simulation_.PlaceBody("shown_object", object->X_WO);
  mj_kinematics(&simulation_.model(), &data);
  mj_comPos(&simulation_.model(), &data);
  mj_camlight(&simulation_.model(), &data);
}

cv::Mat ObserveStage::Picture(int eye) {
  return renderer_->Bgr(simulation_.data(), CameraView::Named(kEyeCameras[eye]));
}

PerFinger<double> ObserveStage::VisibleCaps(int eye) {
  const auto counts =
      renderer_->CountVisible(simulation_.data(), CameraView::Named(kEyeCameras[eye]), caps_);
  PerFinger<double> fractions;
  for (int f = 0; f < kNumFingers; ++f) fractions[f] = counts[f].fraction();
  return fractions;
}

}  // namespace springgrasp
