#include "apps/observe_recorded.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "apps/command.h"
#include "apps/observe_truth.h"
#include "base/error.h"
#include "experiment/table.h"
#include "kinematics/human_hand.h"
#include "render/video_writer.h"
#include "sim/kinematic_tree_of.h"
#include "sim/scene_builder.h"
#include "vision/camera_model.h"
#include "vision/overlay.h"
#include "vision/recorded_stereo.h"

namespace springgrasp {
namespace {

std::optional<double> MarkerHue(const std::string& text) {
  if (text == "auto") return std::nullopt;
  double hue = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hue);
  ThrowUnless(error == std::errc() && end == text.data() + text.size() && hue >= 0 && hue <= 360,
              "--marker-hue is '{}', expected auto or 0 to 360 (0 red, 120 green, 240 blue)", text);
  return hue;
}

CapShape Cap(const ObserveRecordedOptions& options) {
  // A thimble's end is the pad's sphere; its other end goes on along the finger.
  CapShape cap{0.5 * options.cap_diameter, options.cap_length, options.cap_centre, true};
  if (options.cap_length == 0 && options.cap_centre == 0) return cap;
  ThrowUnless(cap.radius > 0, "--cap-length and --cap-centre need --cap-diameter too");
  ThrowUnless(options.cap_length == 0 || options.cap_length >= options.cap_diameter,
              "--cap-length is {}, expected at least the diameter {}: caps are as long as wide or "
              "longer",
              options.cap_length, options.cap_diameter);
  ThrowUnless(options.cap_centre <= cap.full_length(),
              "--cap-centre is {}, expected a place within a cap of length {}", options.cap_centre,
              cap.full_length());
  return cap;
}

TrackDemonstrationOptions TrackingOptions(const ObserveRecordedOptions& options) {
  TrackDemonstrationOptions tracking;
  tracking.tracker.kind = options.tracker;
  tracking.tracker.cap = Cap(options);
  tracking.tracker.colour.hue_deg = MarkerHue(options.marker_hue);
  tracking.tracker.hand = options.hand == "left" ? Handedness::kLeft : Handedness::kRight;
  tracking.frame = options.camera_pose.empty() ? "camera_left" : "world";
  return tracking;
}

// H.264 wants even numbers of pixels.
cv::Mat Even(const cv::Mat& picture) {
  if (picture.cols % 2 == 0 && picture.rows % 2 == 0) return picture;
  cv::Mat even;
  cv::copyMakeBorder(picture, even, 0, picture.rows % 2, 0, picture.cols % 2, cv::BORDER_REPLICATE);
  return even;
}

void Print(const Demonstration& demonstration, const TrackingSummary& summary, double hue_deg) {
  std::vector<std::vector<std::string>> rows = {{"finger", "located in % of frames"}};
  for (int f = 0; f < kNumFingers; ++f) {
    rows.push_back(
        {std::string(kFingerNames[f]), fmt::format("{:.1f}", 100 * summary.coverage[f])});
  }
  fmt::print("{}", AlignColumns(rows));
  fmt::print("epipolar residual: median {:.2f} px\n", summary.epipolar_px);
  fmt::print("caps: {:.1f} mm wide, hue {:.0f} degrees\n", 2e3 * summary.cap.radius, hue_deg);
  int placed = 0, turned = 0;
  for (const DemonstrationSample& sample : demonstration.samples) {
    placed += sample.p_WH.has_value();
    turned += sample.R_WH.has_value();
  }
  if (placed == 0) {
    fmt::print("hand: not found, the wrist's columns are empty\n");
    return;
  }
  const double n = 0.01 * static_cast<double>(demonstration.samples.size());
  fmt::print(
      "hand: position in {:.0f} %, orientation in {:.0f} % of frames, length {:.0f} mm as "
      "estimated\n",
      placed / n, turned / n, 1e3 * kMmmHandLength * summary.hand_scale);
}

}  // namespace

int ObserveRecorded(const ObserveRecordedOptions& options) {
  const Pose X_WL = options.camera_pose.empty() ? Pose::Identity()
                                                : ParsePose(options.camera_pose, "--camera-pose");
  const TrackDemonstrationOptions tracking = TrackingOptions(options);
  std::optional<RecordedTruth> truth;
  if (!options.truth.empty()) truth = ReadRecordedTruth(options.truth);
  RecordedStereo recorded(options.left, options.right, options.fps);
  const StereoCameras cameras = ReadStereoCalibration(
      options.intrinsics, options.extrinsics, recorded.size().width, recorded.size().height, X_WL);
  const ModelPtr human = LoadModelFile(
      ModelPath(options.hand == "left" ? "mmm_hand/mmm_hand_l.xml" : "mmm_hand/mmm_hand_r.xml"));
  const KinematicTree hand = KinematicTreeOf(*human, "mmm_hand");

  std::optional<VideoWriter> video;
  if (!options.overlay.empty()) video.emplace(options.overlay, recorded.fps());
  double hue_deg = 0;
  const InstantCallback draw = [&](const TrackedInstant& instant) {
    hue_deg = instant.tracker.colour().hue_deg;
    if (!video) return;
    if (video->frames() == 0) MakeFolderOf(options.overlay);
    OverlayOptions overlay;
    overlay.t = instant.frame.t;
    if (instant.hand != nullptr) overlay.X_WH = instant.hand->X_WH;
    for (int v = 0; v < 2 && options.particles; ++v) {
      overlay.particles[v] = &instant.tracker.particles(v);
    }
    video->Add(Even(DrawOverlay(instant.frame.left, instant.frame.right, cameras, instant.tracked,
                                instant.tracker.cap().radius, overlay)));
  };
  RandomEngine engine = MakeStream(options.seed, 0, "observation");
  TrackingSummary summary;
  Demonstration demonstration;
  try {
    demonstration = TrackStereo([&] { return recorded.Next(); }, cameras, &hand, tracking, engine,
                                draw, &summary);
  } catch (const Error& e) {
    Fail("{}: {}", recorded.broke_off().value_or(options.left), e.what());
  }
  demonstration.source = options.left;
  if (options.camera_pose.empty()) demonstration.up.reset();
  if (recorded.broke_off()) {
    demonstration.comments.push_back("ended early: " + *recorded.broke_off());
  }
  MakeFolderOf(options.output);
  WriteDemonstration(demonstration, options.output);
  if (video) video->Finish();
  fmt::print("{}: {} samples at {:g} Hz, frame {}\n", options.output, demonstration.samples.size(),
             recorded.fps(), tracking.frame);
  Print(demonstration, summary, hue_deg);
  if (truth) PrintErrors(demonstration, X_WL, *truth, 1 / recorded.fps());
  if (!recorded.broke_off()) return kDone;
  fmt::print(stderr, "springgrasp: {}; what was tracked is kept\n", *recorded.broke_off());
  return kStoppedEarly;
}

}  // namespace springgrasp
