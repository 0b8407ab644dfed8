#include "experiment/observe_stage.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "render/camera_geometry.h"
#include "sim/display_furniture.h"
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
  ModelPtr model = BuildModel(scene, options);
  // The ideal picture before a lens is larger than what the lens shows.
  model->vis.global.offwidth = 4 * scene.eyes.width;
  model->vis.global.offheight = 4 * scene.eyes.height;
  return model;
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
      settings_(scene.eyes),
      occlusion_(scene.demonstrator.occlusion),
      clutter_(scene.demonstrator.clutter),
      object_drawn_(shown.has_value()) {
  const mjModel& m = simulation_.model();
  if (scene.demonstrator.cap_colour) cap_hue_deg_ = HueDeg(*scene.demonstrator.cap_colour);
  simulation_.Forward();
  RenderOptions options;
  options.width = settings_.width;
  options.height = settings_.height;
  const double fovy_deg = CameraFovyDeg(m, kEyeCameras[0]);
  for (int eye = 0; eye < 2; ++eye) {
    const Eigen::Matrix3d K =
        PinholeMatrix(CameraFovyDeg(m, kEyeCameras[eye]), options.width, options.height);
    (eye == 0 ? pinholes_.left : pinholes_.right) = PinholeCamera(
        options.width, options.height, K, CameraPose(m, simulation_.data(), kEyeCameras[eye]));
  }
  eyes_ = pinholes_;
  std::copy(settings_.distortion.begin(), settings_.distortion.end(),
            eyes_.left.distortion.begin());
  eyes_.right.distortion = eyes_.left.distortion;
  if (eyes_.left.distorted()) {
    lens_ = MakeLensView(options.width, options.height, fovy_deg, settings_.distortion);
    options.width = lens_->width;
    options.height = lens_->height;
  }
  renderer_ = std::make_unique<CameraRenderer>(m, options);
  for (const std::string& joint : hand_.tree.joint_names) {
    joint_addresses_.push_back(m.jnt_qposadr[IdOf(m, mjOBJ_JOINT, joint)]);
  }
  for (const std::string_view finger : kFingerNames) {
    caps_.push_back(IdOf(m, mjOBJ_GEOM, CapOf(finger)));
  }
}

Eigen::Vector3d ObserveStage::BetweenEyes() const {
  return (eyes_.left.X_WC.translation() + eyes_.right.X_WC.translation()) / 2;
}

void ObserveStage::Show(const HandMotionSample& sample,
                        const std::optional<DemonstratedObject>& object, bool covered) {
  mjData& data = simulation_.mutable_data();
  for (std::size_t j = 0; j < joint_addresses_.size(); ++j) {
    data.qpos[joint_addresses_[j]] = sample.q[static_cast<int>(j)];
  }
  simulation_.PlaceBody("mmm_hand", sample.X_WH);
  if (object && object_drawn_) simulation_.PlaceBody("shown_object", object->X_WO);
  mj_kinematics(&simulation_.model(), &data);
  if (!occlusion_.fingers.empty()) PutPlates(covered);
  mj_comPos(&simulation_.model(), &data);
  mj_camlight(&simulation_.model(), &data);
}

void ObserveStage::PutPlates(bool covered) {
  mjData& data = simulation_.mutable_data();
  for (const int finger : occlusion_.fingers) {
    Pose X_WP = Pose::Identity();
    X_WP.translation() = Eigen::Vector3d(0, 0, -5);
    if (covered) {
      const double* at = data.geom_xpos + 3 * caps_[static_cast<std::size_t>(finger)];
      const Eigen::Vector3d p_WF(at[0], at[1], at[2]);
      const Eigen::Vector3d ahead = (BetweenEyes() - p_WF).normalized();
      X_WP = LookAtPose(p_WF + kOccluderAhead * ahead, BetweenEyes());
    }
    simulation_.PlaceBody(OccluderName(finger), X_WP);
  }
  mj_kinematics(&simulation_.model(), &data);
}

void ObserveStage::ArrangeClutter(const HandMotion& shown, RandomEngine& engine) {
  if (clutter_ == 0) return;
  const Eigen::Vector3d p_WE = BetweenEyes();
  const Eigen::Matrix3d& R = pinholes_.left.X_WC.linear();
  double hand = 0;  // m, mean distance
  for (const HandMotionSample& sample : shown.samples) {
    hand += (R.transpose() * (sample.X_WH.translation() - p_WE)).z() / double(shown.samples.size());
  }
  // Each thing has a column of the picture of its own, drawn by lot.
  std::vector<std::pair<double, int>> lots;
  for (int i = 0; i < clutter_; ++i) lots.emplace_back(Uniform01(engine), i);
  std::sort(lots.begin(), lots.end());
  const double tan_y = pinholes_.left.height / (2 * pinholes_.left.fy);
  const double tan_x = pinholes_.left.width / (2 * pinholes_.left.fx);
  for (int column = 0; column < clutter_; ++column) {
    // From -1 to 1 over the picture; at its sides things stand nearer.
    const double u = 1.1 * (2 * (column + Uniform(engine, 0.2, 0.8)) / clutter_ - 1);
    const double v = Uniform(engine, -0.8, 0.8);
    const bool beside = std::abs(u) > 0.75;
    const double depth = hand + (beside ? Uniform(engine, 0.15, 0.25) : Uniform(engine, 0.35, 0.7));
    const double yaw = Uniform(engine, -M_PI, M_PI);
    const Eigen::Vector3d p_WQ = p_WE + depth * (R * Eigen::Vector3d(u * tan_x, v * tan_y, 1));
    simulation_.PlaceBody(
        ClutterName(lots[static_cast<std::size_t>(column)].second),
        MakePose(p_WQ, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()))));
  }
}

CameraView ObserveStage::View(int eye) const {
  if (!lens_) return CameraView::Named(kEyeCameras[eye]);
  return CameraView::Free(eyes_.view(eye).X_WC, lens_->fovy_deg);
}

cv::Mat ObserveStage::Picture(int eye) {
  const cv::Mat ideal = renderer_->Bgr(simulation_.data(), View(eye));
  return lens_ ? Distorted(*lens_, ideal) : ideal;
}

PerFinger<double> ObserveStage::VisibleCaps(int eye) {
  const auto counts = renderer_->CountVisible(simulation_.data(), View(eye), caps_);
  PerFinger<double> fractions;
  for (int f = 0; f < kNumFingers; ++f) fractions[f] = counts[f].fraction();
  return fractions;
}

}  // namespace springgrasp
