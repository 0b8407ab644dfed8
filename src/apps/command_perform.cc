// springgrasp perform: one grasp of the library in physics.
#include <memory>

#include "apps/command.h"
#include "apps/perform_once.h"
#include "base/error.h"

namespace springgrasp {
namespace {

struct Options {
  std::string grasp, scene;
  PerformOnceOptions once;
};

int Perform(const Options& options) {
  CheckOutputPaths(options.once);
  const Grasp grasp = ReadGrasp(options.grasp);
  const Scene scene = ReadScene(options.scene);
  ThrowUnless(!scene.objects.empty(), "{}: the scene has no object to grasp", options.scene);
  PerformOnce(grasp, scene, options.once);
  return kDone;
}

}  // namespace

void AddPerformCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(
      app, "perform", "Performs a learned grasp once in a simulated scene and judges it.",
      "experiments/first_grasps/pinch.yaml --scene scenes/pinch_ball.yaml -o out/perform");
  command->add_option("grasp", options->grasp, "grasp YAML of `learn`")->required();
  command->add_option("--scene", options->scene, "scene YAML")->required();
  AddPerformOnceOptions(*command, options->once);
  command->callback([options, &exit_code] { exit_code = Perform(*options); });
}

}  // namespace springgrasp
