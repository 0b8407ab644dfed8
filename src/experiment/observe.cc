#include "experiment/observe.h"

#include <algorithm>
#include <utility>

#include "base/error.h"
#include "base/pipelined.h"
#include "experiment/demonstrator_recorded.h"
#include "experiment/demonstrator_synthesise.h"
#include "experiment/observe_placement.h"
#include "experiment/simulated_eyes.h"
#include "render/video_writer.h"
#include "vision/overlay.h"

namespace springgrasp {
namespace {

// Puts a track on the instants of the truth; those from before the caps were found stay empty.
std::vector<DemonstrationSample> OnInstantsOf(const Demonstration& truth,
                                              const std::vector<DemonstrationSample>& track) {
  constexpr double kSame = 1e-4;  // s
  std::vector<DemonstrationSample> samples;
  std::size_t next = 0;
  for (const DemonstrationSample& shown : truth.samples) {
    while (next < track.size() && track[next].t < shown.t - kSame) ++next;
    DemonstrationSample sample;
    if (next < track.size() && track[next].t < shown.t + kSame) sample = track[next];
    sample.t = shown.t;
    samples.push_back(sample);
  }
  return samples;
}

TrackerKind KindOf(const std::string& name) {
  const auto kind = std::find(kTrackerKinds.begin(), kTrackerKinds.end(), name);
  ThrowUnless(kind != kTrackerKinds.end(), "the tracker is '{}', expected one of {}", name,
              fmt::join(kTrackerKinds, ", "));
  return static_cast<TrackerKind>(kind - kTrackerKinds.begin());
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
    motion = SynthesiseGrasp(hand, {who.type, *shape, who.approach}, engine);
  }
  const HandMotion as_performed = WithLeadIn(motion, hand.open);
  Pose X_WM;
  if (who.X_WO && motion.object) {
    X_WM = *who.X_WO * motion.object->X_WO.inverse();
  } else {
    if (who.distance) display.near = display.far = *who.distance;
    display.margin_px *= stage.pinholes().left.height / 480.0;
    // By the motion as it is: speed and lens do not move the place.
    X_WM = PlaceInDisplay(hand, as_performed, stage.pinholes(), display).X_WM;
  }
  motion = who.speed ? WithLeadIn(AtPeakSpeed(motion, *who.speed), hand.open) : as_performed;
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
  SceneEyes settings = stage.eyes_settings();
  if (options.noise) settings.noise = *options.noise;
  SimulatedEyes eyes(stage, settings, motion, result.shown, engine);
  std::size_t next = 0;
  const FrameSource camera = [&]() -> std::optional<StereoFrame> {
    for (; next < result.shown.samples.size(); ++next) {
      if (!eyes.IsDropped(next)) break;
      if (result.shown.samples[next].t >= 0 && options.measure_visible) {
        result.visible.push_back(PerFinger<double>{});
      }
    }
    if (next == result.shown.samples.size()) return std::nullopt;
    const HandMotionSample& shown = result.shown.samples[next];
    const StereoFrame frame = eyes.Look(next);
    if (shown.t >= 0 && options.measure_visible) {
      eyes.Show(next);
      const PerFinger<double> left = stage.VisibleCaps(0), right = stage.VisibleCaps(1);
      PerFinger<double> both;
      for (int f = 0; f < kNumFingers; ++f) {
        both[f] = shown.recorded[f] ? std::min(left[f], right[f]) : 0;
      }
      result.visible.push_back(both);
    }
    if (!options.frames_folder.empty()) {
      WriteImage(fmt::format("{}/left_{:04d}.png", options.frames_folder, next), frame.left);
      WriteImage(fmt::format("{}/right_{:04d}.png", options.frames_folder, next), frame.right);
    }
    ++next;
    return frame;
  };
  std::optional<VideoWriter> video;
  if (!options.overlay.empty()) video.emplace(options.overlay, options.fps);
  const InstantCallback draw = [&](const TrackedInstant& instant) {
    if (!video) return;
    OverlayOptions overlay;
    overlay.t = std::max(0.0, instant.frame.t);
    if (instant.hand != nullptr) overlay.X_WH = instant.hand->X_WH;
    for (int v = 0; v < 2 && options.particles; ++v) {
      overlay.particles[v] = &instant.tracker.particles(v);
    }
    video->Add(DrawOverlay(instant.frame.left, instant.frame.right, eyes.told(), instant.tracked,
                           instant.tracker.cap().radius, overlay));
  };
  TrackDemonstrationOptions tracking;
  tracking.tracker.kind = KindOf(options.tracker.value_or(settings.tracker));
  tracking.lead_in = -result.shown.samples.front().t;
  if (stage.shows_object()) tracking.object = motion.object;
  if (stage.cap_hue_deg()) tracking.tracker.colour.hue_deg = stage.cap_hue_deg();
  try {
    // The rendering context belongs to this thread.
    Pipelined<StereoFrame>(camera, [&](const FrameSource& rendered) {
      result.tracked = TrackStereo(rendered, eyes.told(), &stage.common_hand(), tracking, engine,
                                   draw, &result.summary);
    });
  } catch (const NotTracked& e) {
    if (options.throw_untracked) throw;
    result.untracked = e.what();
    while (camera()) continue;  // what was visible still counts
  }
  if (video && !result.untracked.empty()) video.reset();
  if (video) video->Finish();
  result.tracked.source = motion.source;
  result.tracked.up = motion.up;
  result.tracked.object = motion.object;
  result.tracked.comments = motion.comments;
  result.tracked.samples = OnInstantsOf(result.truth, result.tracked.samples);
  result.errors = CompareToTruth(result.tracked, result.truth, result.visible);
  return result;
}

Observation Observe(const Scene& scene, RandomEngine& engine, const ObserveOptions& options) {
  ObserveStage stage(scene, scene.demonstrator.object_visible ? ShownShape(scene) : std::nullopt);
  return ObserveMotion(stage, PrepareDemonstration(scene, stage, engine), engine, options);
}

}  // namespace springgrasp
