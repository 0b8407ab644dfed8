// springgrasp inspect: what a model or scene holds, in words and as a picture.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "base/error.h"
#include "base/files.h"
#include "base/fingers.h"
#include "experiment/reach_report.h"
#include "render/camera_renderer.h"
#include "render/video_writer.h"
#include "sim/describe_model.h"
#include "sim/measure_drives.h"
#include "sim/model_index.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

struct Options {
  std::string input, picture, camera, keyframe, drives;
  bool reach = false;
};

constexpr double kPadAngle = 0.5;               // rad, of both joints while a pad pushes
constexpr double kPadPressures[] = {2.5, 5.0};  // bar

// Step response of every valve to its mid pressure, in words and as CSV; pad forces in words.
void MeasureDrives(const mjModel& model, const std::string& path) {
  std::string csv = "valve,pressure_bar,t,chamber_bar,angle_rad\n";
  fmt::print("\nvalves: step to the pressure that balances the spring in mid range\n");
  fmt::print("  {:<24} {:>5}  {:>11}  {:>8}  {}\n", "", "bar", "63.2 % bar", "90 % way",
             "steady angle (balance), rad");
  const std::vector<std::string> valves = ValvesOf(model);
  for (const std::string& valve : valves) {
    const DriveStep step = MeasureDriveStep(model, valve, MidPressure(model, valve));
    std::string angles;
    for (std::size_t i = 0; i < step.joints.size(); ++i) {
      angles +=
          fmt::format("{}{:.3f} ({:.3f})", i > 0 ? ", " : "", step.steady[i], step.balance[i]);
    }
    fmt::print("  {:<24} {:>5.3f}  {:>9.3f} s  {:>6.2f} s  {}\n", valve, step.pressure,
               step.time_constant, step.rise_time, angles);
    for (std::size_t i = 0; i < step.t.size(); i += 5) {
      csv += fmt::format("{},{:.4f},{:.3f},{:.4f},{:.4f}\n", valve, step.pressure, step.t[i],
                         step.p[i], step.q[i]);
    }
  }
  fmt::print("\nforce of a pad that is held, along its normal, both joints at {} rad, N\n",
             kPadAngle);
  for (const std::string hand : {"hand_r", "hand_l"}) {
    if (FindId(model, mjOBJ_JOINT, hand + "_index_j0") < 0) continue;
    for (const std::string_view finger : kFingerNames) {
      std::string forces;
      for (const double pressure : kPadPressures) {
        forces += fmt::format(
            "  {:5.2f} at {} bar",
            MeasurePadForce(model, hand, std::string(finger), kPadAngle, pressure), pressure);
      }
      fmt::print("  {:<24}{}\n", fmt::format("{}_{}", hand, finger), forces);
    }
  }
  WriteFileAtomically(path, csv);
}

ModelPtr LoadEither(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension();
  if (extension == ".xml") return LoadModelFile(path);
  if (extension == ".yaml" || extension == ".yml") {
    BuildOptions build;
    build.offscreen_samples = 4;
    return BuildModel(ReadScene(path), build);
  }
  Fail("{}: expected a model (.xml) or a scene (.yaml)", path);
}

// A map of where the hand can grasp in a scene.
int InspectReach(const Options& options) {
  const std::string extension = std::filesystem::path(options.input).extension();
  ThrowUnless(extension == ".yaml" || extension == ".yml", "{}: --reach needs a scene (.yaml)",
              options.input);
  const Scene scene = ReadScene(options.input);
  // Moves of torso and platform are shown whether or not the scene lets a trial use them.
  const ReachReport report = ReportReach(scene, {true, true}, {});
  fmt::print("{}", FormatReachReport(report));
  if (!options.picture.empty()) {
    MakeFolderOf(options.picture);
    WriteImage(options.picture, DrawReachReport(report, scene));
  }
  return kDone;
}

int Inspect(const Options& options) {
  if (!options.picture.empty()) CheckOutputPath(options.picture);
  if (options.reach) {
    ThrowUnless(options.drives.empty() && options.camera.empty() && options.keyframe.empty(),
                "--reach goes with -o only, not with --drives, --camera or --keyframe");
    return InspectReach(options);
  }
  if (!options.drives.empty()) CheckOutputPath(options.drives);
  const ModelPtr model = LoadEither(options.input);
  ThrowUnless(options.drives.empty() || !ValvesOf(*model).empty(),
              "{}: --drives needs a model with valves (actuators with a pressure), found none",
              options.input);
  if (!options.keyframe.empty()) IdOf(*model, mjOBJ_KEY, options.keyframe);
  if (!options.camera.empty()) IdOf(*model, mjOBJ_CAMERA, options.camera);
  fmt::print("{}", DescribeModel(*model));
  if (!options.picture.empty()) {
    MakeFolderOf(options.picture);
    WriteImage(options.picture, PictureOf(*model, 960, 720, options.camera, options.keyframe));
  }
  if (!options.drives.empty()) {
    MakeFolderOf(options.drives);
    MeasureDrives(*model, options.drives);
  }
  return kDone;
}

}  // namespace

void AddInspectCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "inspect", "Lists joints, actuators, cameras and masses of a model or scene.",
                 "scenes/power_cylinder.yaml -o out/power_cylinder.png");
  command->add_option("input", options->input, "MODEL.xml or SCENE.yaml")->required();
  command->add_option("-o,--output", options->picture, "PNG picture");
  command->add_option("--drives", options->drives,
                      "CSV of the step response of every valve (measured; pad forces are printed)");
  command->add_option("--camera", options->camera, "camera of the picture (default: an overview)");
  command->add_option("--keyframe", options->keyframe,
                      "posture of the picture (default: the first keyframe)");
  command->add_flag("--reach", options->reach,
                    "map of where the right hand can grasp in a scene, in words and with -o as a "
                    "picture");
  command->callback([options, &exit_code] { exit_code = Inspect(*options); });
}

}  // namespace springgrasp
