// Pictures of the human hand of the MMM on its way through a shipped grasp, as planned from the
// springs' fingertips: the middle row of the paper's Figs. 7 and 8.
//   grasp_strip FOLDER    writes FOLDER/<type>_<part of T in percent>.png
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "experiment/grasp_requests.h"
#include "grasp/generate.h"
#include "grasp_cases.h"
#include "kinematics/smooth_hand_ik.h"
#include "render/camera_geometry.h"
#include "render/camera_renderer.h"
#include "sim/kinematic_tree_of.h"
#include "sim/model_index.h"
#include "sim/mujoco_handles.h"
#include "sim/scene_builder.h"
#include "statistics_main.h"

namespace springgrasp {
namespace {

constexpr double kDt = 0.005;
constexpr double kParts[] = {0.05, 0.4, 0.65, 0.85, 1.0};  // of T

// A shape as spheres, for a renderer that knows marks only.
std::vector<Mark> MarksOf(const Shape& shape, const Pose& X_HO) {
  std::vector<Mark> marks;
  const auto add = [&](const Eigen::Vector3d& p_O, double radius) {
    Mark mark;
    mark.p_W = X_HO * p_O;
    mark.radius = radius;
    mark.rgba = {0.3, 0.5, 0.8, 0.6};
    marks.push_back(mark);
  };
  const Eigen::Vector3d half = shape.size / 2;
  const double thin = half.minCoeff();
  if (shape.kind == Shape::Kind::kSphere) {
    add(Eigen::Vector3d::Zero(), half.x());
  } else if (shape.kind == Shape::Kind::kCylinder) {
    for (double z = -half.z() + 0.01; z < half.z(); z += 0.006) add({0, 0, z}, half.x());
  } else {
    const double step = std::max(thin, 0.003);
    for (double x = -half.x() + thin; x <= half.x() - thin + 1e-9; x += step) {
      for (double y = -half.y() + thin; y <= half.y() - thin + 1e-9; y += step)
        add({x, y, 0}, thin);
    }
  }
  return marks;
}

int Main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "expected: grasp_strip FOLDER\n");
    return 2;
  }
  std::filesystem::create_directories(argv[1]);
  const ModelPtr model = LoadModelFile(ModelPath("mmm_hand/mmm_hand_r.xml"));
  const DataPtr data = MakeData(*model);
  const HumanHand shipped = MakeHumanHand(KinematicTreeOf(*model, "mmm_hand"));
  CameraRenderer renderer(*model, RenderOptions::Pretty(480, 400));
  for (const Grasp& grasp : ReadLibrary()) {
    const double scale = grasp.hand_length / kMmmHandLength;
    const HumanHand human = ScaledHand(shipped, scale);
    GenerateOptions options;
    options.shape = grasp.shape;
    options.tip_radius = grasp.tip_radius;
    options.dt = kDt;
    options.X_WO = MakePose({0.39, 0.5, 1.0}, Eigen::Quaterniond::Identity());
    const FingertipMotion motion = GenerateMotion(grasp, options);
    const std::vector<Eigen::VectorXd> q =
        SolveHandMotionSmoothly(human, TipsOf(motion), {.dt = kDt});
    for (const double part : kParts) {
      const auto i = static_cast<std::size_t>(std::lround(part * motion.T / kDt));
      for (int j = 0; j < human.tree.num_joints(); ++j) {
        const int id = IdOf(*model, mjOBJ_JOINT, human.tree.joint_names[j]);
        data->qpos[model->jnt_qposadr[id]] = q[i][j];
      }
      mj_kinematics(model.get(), data.get());
      mj_comPos(model.get(), data.get());
      mj_camlight(model.get(), data.get());
      Pose X_HO = motion.samples[i].X_WH.inverse() * options.X_WO;
      X_HO.translation() /= scale;
      std::vector<Mark> marks = MarksOf(grasp.shape, X_HO);
      for (int f = 0; f < kNumFingers; ++f) {
        if (!motion.involved[f]) continue;
        Mark mark;
        mark.p_W = motion.samples[i].p_HF[f] / scale;
        mark.radius = 0.0095;
        mark.rgba = {0.9, 0.15, 0.1, 0.8};
        marks.push_back(mark);
      }
      const CameraView view =
          CameraView::Free(LookAtPose({0.14, 0.42, -0.1}, {0.13, 0.01, -0.035}), 27);
      cv::imwrite(fmt::format("{}/{}_{:03.0f}.png", argv[1], grasp.type, 100 * part),
                  renderer.Bgr(*data, view, marks));
    }
  }
  return 0;
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return StatisticsMain(argc, argv, springgrasp::Main); }
