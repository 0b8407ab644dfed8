// springgrasp inspect: what a model or scene holds, in words and as a picture.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "base/error.h"
#include "render/camera_renderer.h"
#include "render/video_writer.h"
#include "sim/describe_model.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

struct Options {
  std::string input, picture, camera;
};

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

int Inspect(const Options& options) {
  if (!options.picture.empty()) CheckOutputPath(options.picture);
  const ModelPtr model = LoadEither(options.input);
  fmt::print("{}", DescribeModel(*model));
  if (!options.picture.empty()) {
    MakeFolderOf(options.picture);
    WriteImage(options.picture, PictureOf(*model, 960, 720, options.camera));
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
  command->add_option("--camera", options->camera, "camera of the picture (default: an overview)");
  command->callback([options, &exit_code] { exit_code = Inspect(*options); });
}

}  // namespace springgrasp
