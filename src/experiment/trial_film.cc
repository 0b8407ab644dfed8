#include "experiment/trial_film.h"

#include <fmt/format.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

constexpr double kVideoFps = 25;
constexpr double kMetresPerNewton = 0.01;  // of a force's arrow
constexpr double kLeastForce = 0.05;       // N, that is drawn
const Eigen::Vector4d kForceColour(0.95, 0.85, 0.1, 1), kPlannedColour(0.2, 0.45, 1, 0.7),
    kReachedColour(0.15, 0.8, 0.25, 0.7);

}  // namespace

TrialFilm::TrialFilm(const Simulation& simulation, const RobotIo& robot, const Scene& scene,
                     const GraspPlan& plan, const FilmOptions& options)
    : robot_(robot),
      plan_(plan),
      options_(options),
      model_(BuildModel(scene)),
      data_(MakeData(*model_)),
      renderer_(*model_, RenderOptions::Pretty(640, 480)),
      writer_(options.file, kVideoFps),
      roles_(ClassifyGeoms(simulation.model())) {
  ThrowUnless(model_->nq == simulation.model().nq, "the filmed model has other joints");
  if (!options.camera.empty()) {
    cameras_ = {options.camera};
  } else {
    for (const SceneCamera& camera : scene.cameras) cameras_.push_back(camera.name);
    if (cameras_.empty()) cameras_ = {"front", "close"};
    if (cameras_.size() > 2) cameras_.resize(2);
  }
}

void TrialFilm::Look(const Simulation& simulation, Phase phase) {
  if (phase == Phase::kReach && reach_from_ < 0) reach_from_ = simulation.time();
  if (simulation.time() < next_) return;
  next_ += 1 / kVideoFps;
  std::copy_n(simulation.data().qpos, model_->nq, data_->qpos);
  mj_kinematics(model_.get(), data_.get());
  mj_comPos(model_.get(), data_.get());
  mj_camlight(model_.get(), data_.get());
  const std::vector<Mark> marks =
      options_.annotate ? Marks(simulation, phase) : std::vector<Mark>();
  std::vector<cv::Mat> views;
  for (const std::string& camera : cameras_) {
    views.push_back(renderer_.Bgr(*data_, CameraView::Named(camera), marks));
  }
  cv::Mat frame;
  cv::hconcat(views, frame);
  DrawText(frame, fmt::format("{:5.2f} s  {}", simulation.time(), PhaseName(phase)));
  writer_.Add(frame);
}

std::vector<Mark> TrialFilm::Marks(const Simulation& simulation, Phase phase) const {
  std::vector<Mark> marks;
  for (const ContactPoint& contact : simulation.contacts()) {
    const GeomRole &role1 = roles_[contact.geom1], &role2 = roles_[contact.geom2];
    const bool held = (role1.hand() && role2.part == GeomPart::kObject) ||
                      (role2.hand() && role1.part == GeomPart::kObject);
    if (!held || contact.f_W.norm() < kLeastForce) continue;
    const Eigen::Vector3d f_W = role1.hand() ? contact.f_W : Eigen::Vector3d(-contact.f_W);
    // The arrow ends where the hand presses.
    marks.push_back({Mark::Kind::kArrow, contact.p_W - kMetresPerNewton * f_W, contact.p_W, 0.003,
                     kForceColour});
  }
  for (int f = 0; f < kNumFingers; ++f) {
    if (!plan_.involved[f]) continue;
    const Eigen::Vector3d reached = robot_.Fingertip(simulation, f);
    marks.push_back({Mark::Kind::kSphere, reached, reached, 0.010, kReachedColour});
    if (phase > Phase::kGrip || reach_from_ < 0) continue;
    const std::size_t k =
        phase == Phase::kReach
            ? static_cast<std::size_t>((simulation.time() - reach_from_) / plan_.dt)
            : plan_.p_WF.size();
    const Eigen::Vector3d& planned = plan_.p_WF[std::min(k, plan_.p_WF.size() - 1)][f];
    marks.push_back({Mark::Kind::kSphere, planned, planned, 0.0102, kPlannedColour});
  }
  return marks;
}

}  // namespace springgrasp
