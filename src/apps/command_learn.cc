// springgrasp learn: DMP and virtual springs from a demonstration.
#include <fmt/format.h>

#include <memory>

#include "apps/command.h"
#include "apps/learn_options.h"
#include "demonstration/demonstration.h"
#include "demonstration/half_seen.h"
#include "demonstration/steady_hand.h"
#include "grasp/learn.h"

namespace springgrasp {
namespace {

struct Options {
  std::string demonstration, output, object, pose, steady;
  LearnOptions learn;
};

int Learn(Options options) {
  CheckOutputPath(options.output);
  if (!options.steady.empty()) CheckOutputPath(options.steady);
  const Demonstration demonstration = ReadDemonstration(options.demonstration);
  if (!options.object.empty()) {
    DemonstratedObject object;
    object.shape = ParseShape(options.object);
    object.X_WO = ParsePose(options.pose, "--pose");
    options.learn.object = object;
  }
  const Grasp grasp = LearnGrasp(demonstration, options.learn);
  MakeFolderOf(options.output);
  WriteGrasp(grasp, options.output);
  if (!options.steady.empty()) {
    MakeFolderOf(options.steady);
    WriteDemonstration(WithSteadyHand(WithoutHalfSeenTips(demonstration), grasp.involved),
                       options.steady);
  }
  fmt::print("{}", ReportGrasp(grasp));
  return kDone;
}

}  // namespace

void AddLearnCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(
      app, "learn", "Learns a grasp from a demonstration: reach, contacts, spring constants.",
      "experiments/first_grasps/pinch.csv --type pinch -o out/pinch.yaml");
  command->add_option("demonstration", options->demonstration, "demonstration CSV")->required();
  AddLearnOptions(*command, options->learn);
  command->add_option("-o,--output", options->output, "grasp YAML")->required();
  command->add_option("--name", options->learn.name, "of the library entry (default: the type)");
  command->add_option("--steady", options->steady,
                      "demonstration CSV to write: the hand as learning sees it, steadied by the "
                      "fingertips");
  CLI::Option* object = command->add_option(
      "--object", options->object,
      "the object that was grasped: sphere:D, cylinder:DxH or box:XxYxZ, metres");
  CLI::Option* pose = command->add_option("--pose", options->pose,
                                          "its pose \"x y z qw qx qy qz\" in the frame of the CSV");
  object->needs(pose);
  pose->needs(object);
  command->callback([options, &exit_code] { exit_code = Learn(*options); });
}

}  // namespace springgrasp
