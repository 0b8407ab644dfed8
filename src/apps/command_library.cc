// springgrasp library, recognise: what grasps there are, and which one a demonstration is.
#include <fmt/format.h>

#include <memory>

#include "apps/command.h"
#include "demonstration/demonstration.h"
#include "experiment/table.h"
#include "grasp/library.h"

namespace springgrasp {
namespace {

std::string Fingers(const PerFinger<bool>& involved) {
  std::string out;
  for (int i = 0; i < kNumFingers; ++i) {
    if (involved[i]) out += (out.empty() ? "" : " ") + std::string(kFingerNames[i]);
  }
  return out;
}

int List(const std::string& folder) {
  std::vector<std::vector<std::string>> rows = {
      {"name", "type", "fingers", "object", "T s", "worst involved mm", "check"}};
  std::string wrong;
  for (const LibraryEntry& entry : ReadLibrary(folder)) {
    const Grasp& grasp = entry.grasp;
    double worst = 0;
    for (int i = 0; i < kNumFingers; ++i) {
      if (grasp.involved[i]) worst = std::max(worst, grasp.quality.rmse[i]);
    }
    const std::vector<std::string> problems = CheckGrasp(grasp);
    for (const std::string& problem : problems) wrong += entry.path + ": " + problem + "\n";
    rows.push_back({grasp.name, grasp.type, Fingers(grasp.involved), FormatShape(grasp.shape),
                    fmt::format("{:.2f}", grasp.scales.T), fmt::format("{:.1f}", 1e3 * worst),
                    problems.empty() ? "ok" : "FAILED"});
  }
  fmt::print("{}{}", AlignColumns(rows), wrong);
  return wrong.empty() ? kDone : kCheckFailed;
}

int Recognise(const std::string& demonstration, const std::string& folder) {
  std::vector<std::vector<std::string>> rows = {{"grasp", "type", "RMSE mm"}};
  for (const RecognisedGrasp& grasp :
       RecogniseGrasp(ReadDemonstration(demonstration), ReadLibrary(folder))) {
    rows.push_back({grasp.name, grasp.type, fmt::format("{:.1f}", 1e3 * grasp.rmse)});
  }
  fmt::print("{}", AlignColumns(rows));
  return kDone;
}

}  // namespace

void AddLibraryCommand(CLI::App& app, int& exit_code) {
  auto folder = std::make_shared<std::string>(ShippedLibrary());
  CLI::App* command =
      AddCommand(app, "library", "Lists and checks the grasps of a folder.", "models/grasps");
  command->add_option("folder", *folder, "with one YAML per grasp (default: the shipped ones)");
  command->callback([folder, &exit_code] { exit_code = List(*folder); });
}

void AddRecogniseCommand(CLI::App& app, int& exit_code) {
  auto folder = std::make_shared<std::string>(ShippedLibrary());
  auto demonstration = std::make_shared<std::string>();
  CLI::App* command =
      AddCommand(app, "recognise", "Says which grasp of a library a demonstration is, best first.",
                 "experiments/first_grasps/pinch.csv");
  command->add_option("demonstration", *demonstration, "demonstration CSV")->required();
  command->add_option("--library", *folder, "folder of grasps (default: the shipped ones)");
  command->callback([=, &exit_code] { exit_code = Recognise(*demonstration, *folder); });
}

}  // namespace springgrasp
