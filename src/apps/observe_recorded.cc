#include "apps/observe_recorded.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>

#include "apps/command.h"
#include "base/error.h"
#include "base/files.h"
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

Pose CameraPose(const std::string& text) {
  std::istringstream in(text);
  Eigen::Matrix<double, 7, 1> v;
  for (double& x : v) in >> x;
  std::string rest;
  ThrowUnless(!in.fail() && !(in >> rest) && v.allFinite() && v.tail<4>().norm() > 1e-6,
              "--camera-pose is '{}', expected seven numbers x y z qw qx qy qz", text);
  return MakePose(v.head<3>(), Eigen::Quaterniond(v[3], v[4], v[5], v[6]).normalized());
}

std::optional<double> MarkerHue(const std::string& text) {
  if (text == "auto") return std::nullopt;
  double hue = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hue);
  ThrowUnless(error == std::errc() && end == text.data() + text.size() && hue >= 0 && hue <= 360,
              "--marker-hue is '{}', expected auto or 0 to 360 (0 red, 120 green, 240 blue)", text);
  return hue;
}

void Print(const TrackingSummary& summary) {
  std::vector<std::vector<std::string>> rows = {{"finger", "located in % of frames"}};
  for (int f = 0; f < kNumFingers; ++f) {
    rows.push_back(
        {std::string(kFingerNames[f]), fmt::format("{:.0f}", 100 * summary.coverage[f])});
  }
  fmt::print("{}", AlignColumns(rows));
  fmt::print("epipolar residual: median {:.2f} px\n", summary.epipolar_px);
  fmt::print("hand length: {:.0f} mm as estimated\n", 1e3 * kMmmHandLength * summary.hand_scale);
}

}  // namespace

void ObserveRecorded(const ObserveRecordedOptions& options) {
  const Pose X_WL =
      options.camera_pose.empty() ? Pose::Identity() : CameraPose(options.camera_pose);
  TrackDemonstrationOptions tracking;
  tracking.tracker.colour.hue_deg = MarkerHue(options.marker_hue);
  tracking.frame = options.camera_pose.empty() ? "camera_left" : "world";
  RecordedStereo recorded(options.left, options.right, options.fps);
  const StereoCameras cameras = ReadStereoCalibration(
      options.intrinsics, options.extrinsics, recorded.size().width, recorded.size().height, X_WL);
  const ModelPtr human = LoadModelFile(ModelPath("mmm_hand/mmm_hand_r.xml"));
  const KinematicTree hand = KinematicTreeOf(*human, "mmm_hand");

  MakeFolderOf(options.overlay);
  std::optional<VideoWriter> video;
  if (!options.overlay.empty()) video.emplace(options.overlay, recorded.fps());
  const InstantCallback draw = [&](const TrackedInstant& instant) {
    if (!video) return;
    OverlayOptions overlay;
    overlay.t = instant.frame.t;
    if (instant.hand != nullptr) overlay.X_WH = instant.hand->X_WH;
    video->Add(DrawOverlay(instant.frame.left, instant.frame.right, cameras, instant.tracked,
                           instant.tracker.cap().radius, overlay));
  };
  RandomEngine engine = MakeStream(options.seed, 0, "observation");
  TrackingSummary summary;
  Demonstration demonstration = TrackStereo([&] { return recorded.Next(); }, cameras, &hand,
                                            tracking, engine, draw, &summary);
  demonstration.source = options.left;
  if (options.camera_pose.empty()) demonstration.up.reset();
  MakeFolderOf(options.output);
  WriteDemonstration(demonstration, options.output);
  if (video) video->Finish();
  fmt::print("{}: {} samples at {:g} Hz, frame {}\n", options.output, demonstration.samples.size(),
             recorded.fps(), tracking.frame);
  Print(summary);
}

}  // namespace springgrasp
