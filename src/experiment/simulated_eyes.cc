#include "experiment/simulated_eyes.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

// Frames [begin, end) with plates: begun in mid-movement, with time left to recover.
std::pair<std::size_t, std::size_t> CoveredFrames(const HandMotion& shown, int frames,
                                                  RandomEngine engine) {
  const auto first = std::find_if(shown.samples.begin(), shown.samples.end(),
                                  [](const HandMotionSample& s) { return s.t >= 0; });
  const double start = static_cast<double>(first - shown.samples.begin());
  const double count = static_cast<double>(shown.samples.end() - first);
  const double lowest = 0.15 * count;
  const double highest = std::max(lowest, 0.8 * count - frames - 8);
  const auto begin = static_cast<std::size_t>(start + Uniform(engine, lowest, highest));
  return {begin, std::min(shown.samples.size(), begin + static_cast<std::size_t>(frames))};
}

Eigen::Vector3d RandomDirection(RandomEngine& engine) {
  Eigen::Vector3d axis;
  for (int i = 0; i < 3; ++i) axis[i] = Normal(engine);
  return axis.normalized();
}

}  // namespace

RandomEngine SubStream(const RandomEngine& engine, std::string_view name) {
  RandomEngine copy = engine;
  return MakeStream(copy(), 0, name);
}

StereoCameras Miscalibrated(const StereoCameras& cameras, const SceneCalibrationError& error,
                            RandomEngine& engine) {
  StereoCameras told = cameras;
  const Eigen::Vector3d axis = RandomDirection(engine);
  if (error.rotation != 0) {
    told.right.X_WC.linear() =
        cameras.right.X_WC.linear() * Eigen::AngleAxisd(error.rotation, axis).toRotationMatrix();
  }
  for (CameraModel* camera : {&told.left, &told.right}) {
    camera->fx *= 1 + error.focal;
    camera->fy *= 1 + error.focal;
  }
  return told;
}

SimulatedEyes::SimulatedEyes(ObserveStage& stage, const SceneEyes& settings,
                             const HandMotion& motion, const HandMotion& shown,
                             const RandomEngine& engine)
    : stage_(stage),
      settings_(settings),
      motion_(motion),
      shown_(shown),
      noise_engine_(SubStream(engine, "noise")),
      noise_(settings.noise, noise_engine_),
      dropped_(shown.samples.size(), false) {
  RandomEngine calibration = SubStream(engine, "calibration");
  told_ = Miscalibrated(stage.eyes(), settings.calibration_error, calibration);
  RandomEngine light = SubStream(engine, "light"), drops = SubStream(engine, "drops");
  light_phase_ = Uniform01(light);
  for (auto& eye : white_phase_) {
    for (double& phase : eye) phase = Uniform01(light);
  }
  for (std::size_t i = 1; i < dropped_.size(); ++i) {
    dropped_[i] = Uniform01(drops) < settings.frame_drops;
  }
  const SceneOcclusion& occlusion = stage.occlusion();
  if (!occlusion.fingers.empty() && occlusion.frames > 0) {
    std::tie(covered_begin_, covered_end_) =
        CoveredFrames(shown, occlusion.frames, SubStream(engine, "occlusion"));
  }
  RandomEngine clutter = SubStream(engine, "clutter");
  stage.ArrangeClutter(shown, clutter);
}

bool SimulatedEyes::IsCovered(std::size_t frame) const {
  return covered_begin_ <= frame && frame < covered_end_;
}

void SimulatedEyes::Show(std::size_t frame) {
  stage_.Show(shown_.samples[frame], motion_.object, IsCovered(frame));
}

// One per pixel that the fastest fingertip moves while the shutter is open.
int SimulatedEyes::SubframeCount(int eye, double t) const {
  const HandMotionSample a = Interpolated(motion_, t - settings_.exposure / 2);
  const HandMotionSample b = Interpolated(motion_, t + settings_.exposure / 2);
  const HandShape begin = ComputeHandShape(stage_.hand(), a.q);
  const HandShape end = ComputeHandShape(stage_.hand(), b.q);
  const CameraModel& camera = stage_.pinholes().view(eye);
  double farthest = 0;  // px
  for (int f = 0; f < kNumFingers; ++f) {
    const auto from = Project(camera, a.X_WH * begin.tips[f]);
    const auto to = Project(camera, b.X_WH * end.tips[f]);
    if (from && to) farthest = std::max(farthest, (*to - *from).norm());
  }
  return std::clamp(static_cast<int>(std::ceil(farthest)), 1, settings_.subframes);
}

cv::Mat SimulatedEyes::Exposed(int eye, std::size_t frame) {
  const double late = eye == 1 ? settings_.time_offset : 0;
  const double t = shown_.samples[frame].t + late;
  const int count = settings_.exposure > 0 ? SubframeCount(eye, t) : 1;
  if (count == 1) {
    stage_.Show(late == 0 ? shown_.samples[frame] : Interpolated(motion_, t), motion_.object,
                IsCovered(frame));
    return stage_.Picture(eye);
  }
  PictureMean mean;
  for (const double dt : SubframeTimes(settings_.exposure, count)) {
    stage_.Show(Interpolated(motion_, t + dt), motion_.object, IsCovered(frame));
    mean.Add(stage_.Picture(eye));
  }
  return mean.Mean();
}

StereoFrame SimulatedEyes::Look(std::size_t frame) {
  const double t = shown_.samples[frame].t;
  StereoFrame seen{t, Exposed(0, frame), Exposed(1, frame)};
  const double begin = shown_.samples.front().t, end = shown_.samples.back().t;
  const double part = (t - begin) / std::max(1e-9, end - begin);
  const bool gains = settings_.brightness_drift != 0 || settings_.white_balance_drift != 0;
  for (int eye = 0; eye < 2; ++eye) {
    cv::Mat& picture = eye == 0 ? seen.left : seen.right;
    if (gains) {
      std::array<double, 3> gain;
      for (std::size_t c = 0; c < 3; ++c) {
        gain[c] = DriftGain(settings_.brightness_drift, part, light_phase_) *
                  DriftGain(settings_.white_balance_drift, part,
                            white_phase_[static_cast<std::size_t>(eye)][c]);
      }
      ApplyGains(picture, gain);
    }
    noise_.AddTo(picture, noise_engine_);
  }
  return seen;
}

}  // namespace springgrasp
