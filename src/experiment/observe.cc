#include "experiment/observe.h"

#include <cmath>

#include "base/error.h"
#include "experiment/demonstrator_recorded.h"
#include "experiment/demonstrator_synthesise.h"
#include "experiment/observe_noise.h"
#include "experiment/observe_placement.h"
#include "render/video_writer.h"
#include "vision/fingertip_tracker.h"
#include "vision/overlay.h"

namespace springgrasp {
namespace {

DemonstrationSample SampleOf(const TrackedFrame& frame, double t) {
  DemonstrationSample sample;
  sample.t = t;
  for (int f = 0; f < kNumFingers; ++f) {
    sample.p_WF[f] = frame.fingers[f].p_W;
    sample.confidence[f] = frame.fingers[f].p_W ? frame.fingers[f].confidence : 0;
  }
  return sample;
}

std::string PoseText(const Pose& X) {
  const auto a = PoseToArray(X);
  return fmt::format("{:.4f} {:.4f} {:.4f} {:.5f} {:.5f} {:.5f} {:.5f}", a[0], a[1], a[2], a[3],
                     a[4], a[5], a[6]);
}

}  // namespace

std::optional<Shape> ShownShape(const Scene& scene) {
  const SceneDemonstrator& who = scene.demonstrator;
  if (who.object) return who.object;
  if (who.kind == "recorded") {
    const auto object = ReadDemonstration(who.file).object;
    return object ? std::optional<Shape>(object->shape) : std::nullopt;
  }
  if (!scene.objects.empty()) return scene.objects[0].shape;
  return std::nullopt;
}

HandMotion PrepareDemonstration(const Scene& scene, const ObserveStage& stage,
                                RandomEngine& engine) {
  const SceneDemonstrator& who = scene.demonstrator;
  const DemonstratorHand& hand = stage.hand();
  HandMotion motion;
  DisplayOptions display;
  if (who.kind == "recorded") {
    motion = HandMotionOf(hand, ReadDemonstration(who.file), who.type);
    display.upright = motion.object.has_value();
  } else {
    const std::optional<Shape> shape = ShownShape(scene);
    ThrowUnless(shape.has_value(),
                "{}: demonstrator.object is missing: a synthesised {} needs an "
                "object of known shape",
                scene.source, who.type);
    motion = SynthesiseGrasp(hand, {who.type, *shape}, engine);
  }
  motion = WithLeadIn(motion, hand.open);
  Pose X_WM;
  if (who.X_WO && motion.object) {
    X_WM = *who.X_WO * motion.object->X_WO.inverse();
  } else {
    X_WM = PlaceInDisplay(hand, motion, stage.eyes(), display).X_WM;
  }
  motion = Moved(motion, X_WM);
  motion.comments.push_back("placement: " + PoseText(X_WM));
  return motion;
}

Demonstration TruthOf(const DemonstratorHand& hand, const HandMotion& motion) {
  Demonstration truth;
  truth.source = motion.source;
  truth.up = motion.up;
  truth.object = motion.object;
  truth.comments = motion.comments;
  for (const HandMotionSample& shown : motion.samples) {
    if (shown.t < 0) continue;
    const HandShape shape = ComputeHandShape(hand, shown.q);
    DemonstrationSample sample;
    sample.t = shown.t;
    sample.p_WH = shown.X_WH.translation();
    sample.R_WH = Eigen::Quaterniond(shown.X_WH.linear());
    for (int f = 0; f < kNumFingers; ++f) {
      sample.p_WF[f] = shown.X_WH * shape.tips[f];
      sample.confidence[f] = 1;
    }
    truth.samples.push_back(sample);
  }
  return truth;
}

Observation ObserveMotion(ObserveStage& stage, const HandMotion& motion, RandomEngine& engine,
                          const ObserveOptions& options) {
  Observation result;
  result.shown = Resampled(motion, options.fps);
  result.truth = TruthOf(stage.hand(), result.shown);
  result.tracked.source = motion.source;
  result.tracked.up = motion.up;
  result.tracked.object = motion.object;
  result.tracked.comments = motion.comments;

  FingertipTracker tracker(stage.eyes(), TrackerOptions{});
  PictureNoise noise(options.noise, engine);
  std::optional<VideoWriter> video;
  if (!options.overlay.empty()) video.emplace(options.overlay, options.fps);
  int frame_number = 0;
  for (const HandMotionSample& shown : result.shown.samples) {
    stage.Show(shown, motion.object);
    cv::Mat pictures[2] = {stage.Picture(0), stage.Picture(1)};
    for (cv::Mat& picture : pictures) noise.AddTo(picture, engine);
    TrackedFrame frame;
    if (tracker.started()) {
      frame = tracker.Update(pictures[0], pictures[1], engine);
    } else if (auto first = tracker.Start(pictures[0], pictures[1])) {
      frame = *first;
    }
    if (shown.t >= 0) {
      result.tracked.samples.push_back(SampleOf(frame, shown.t));
      if (options.measure_visible) {
        const PerFinger<double> left = stage.VisibleCaps(0), right = stage.VisibleCaps(1);
        PerFinger<double> both;
        for (int f = 0; f < kNumFingers; ++f) both[f] = std::min(left[f], right[f]);
        result.visible.push_back(both);
      }
    }
    if (!options.frames_folder.empty()) {
      for (int eye = 0; eye < 2; ++eye) {
        WriteImage(fmt::format("{}/{}_{:04d}.png", options.frames_folder,
                               eye == 0 ? "left" : "right", frame_number),
                   pictures[eye]);
      }
    }
    if (video) {
      OverlayOptions overlay;
      overlay.t = std::max(0.0, shown.t);
      video->Add(DrawOverlay(pictures[0], pictures[1], stage.eyes(), frame, tracker.cap().radius,
                             overlay));
    }
    ++frame_number;
  }
  if (video) video->Finish();
  result.errors = CompareToTruth(result.tracked, result.truth, result.visible);
  return result;
}

Observation Observe(const Scene& scene, RandomEngine& engine, const ObserveOptions& options) {
  ObserveStage stage(scene, scene.demonstrator.object_visible ? ShownShape(scene) : std::nullopt);
  return ObserveMotion(stage, PrepareDemonstration(scene, stage, engine), engine, options);
}

}  // namespace springgrasp
