// springgrasp: from a human grasp, seen by a robot, to the robot's own.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>

#include "apps/command.h"
#include "experiment/store.h"
#include "render/osmesa_context.h"

namespace springgrasp {
namespace {

std::string VersionText() {
  return fmt::format("springgrasp {}\nMuJoCo {}\nrenderer {}", SPRINGGRASP_VERSION,
                     mj_versionString(), RendererDescription());
}

// "" if the first argument is a command or an option.
std::string UnknownCommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return "";
  std::string names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (command->get_name() == argv[1]) return "";
    names += (names.empty() ? "" : ", ") + command->get_name();
  }
  return fmt::format("there is no command '{}'; expected one of {}", argv[1], names);
}

// One line, whatever a file put into the message.
int Report(std::string message, int code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  fmt::print(stderr, "springgrasp: {}\n", message);
  return code;
}

int Main(int argc, char** argv) {
  CLI::App app(
      "Learns grasps from human demonstrations as systems of virtual springs, and "
      "performs them with a humanoid robot in physics simulation.");
  app.name("springgrasp");
  app.require_subcommand(1);
  app.set_version_flag("--version", VersionText);
  int exit_code = kDone;
  AddRunCommand(app, exit_code);
  AddReplayCommand(app, exit_code);
  AddStatusCommand(app, exit_code);
  AddExportCommand(app, exit_code);
  AddCheckCommand(app, exit_code);
  AddObserveCommand(app, exit_code);
  AddLearnCommand(app, exit_code);
  AddGenerateCommand(app, exit_code);
  AddPerformCommand(app, exit_code);
  AddGraspCommand(app, exit_code);
  AddLibraryCommand(app, exit_code);
  AddRecogniseCommand(app, exit_code);
  AddInspectCommand(app, exit_code);
  AddModelCommand(app, exit_code);
  const std::string unknown = UnknownCommand(app, argc, argv);
  if (!unknown.empty()) return Report(unknown, kBadInput);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& e) {
    return app.exit(e);  // --help, --version
  } catch (const CLI::ParseError& e) {
    return Report(e.what(), kBadInput);
  } catch (const ForeignDirectory& e) {
    return Report(e.what(), kForeignDirectory);
  } catch (const std::exception& e) {
    return Report(e.what(), kBadInput);
  }
  return exit_code;
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return springgrasp::Main(argc, argv); }
