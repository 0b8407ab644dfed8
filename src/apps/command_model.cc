// springgrasp model: the bare mathematics on a case in JSON.
#include <fmt/format.h>

#include <memory>

#include "apps/command.h"
#include "base/files.h"
#include "experiment/table.h"
#include "grasp/model_case.h"

namespace springgrasp {
namespace {

struct Options {
  std::string model_case, output;
  bool check = false;
};

int Model(const Options& options) {
  if (!options.output.empty()) CheckOutputPath(options.output);
  const Json model_case = ReadModelCase(options.model_case);
  const Json computed = EvaluateModelCase(model_case, options.model_case);
  const std::string text = computed.dump(1) + "\n";
  if (!options.output.empty()) {
    MakeFolderOf(options.output);
    WriteFileAtomically(options.output, text);
  } else if (!options.check) {
    fmt::print("{}", text);
  }
  if (!options.check) return kDone;
  const ModelCaseCheck check = CheckModelCase(model_case, computed, options.model_case);
  std::vector<std::vector<std::string>> rows = {{"key", "largest error", "tolerance", ""}};
  for (const ModelCaseCheck::Entry& entry : check.entries) {
    rows.push_back({entry.key, fmt::format("{:.3g}", entry.error),
                    fmt::format("{:.3g}", entry.tolerance),
                    entry.error <= entry.tolerance ? "ok" : "FAILED"});
  }
  fmt::print("{}{}: largest error {:.3g} of its tolerance, in {}\n", AlignColumns(rows),
             check.passed ? "passed" : "FAILED", check.worst_ratio, check.worst_key);
  return check.passed ? kDone : kCheckFailed;
}

}  // namespace

void AddModelCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = AddCommand(
      app, "model", "Evaluates a case of the spring model or DMP and writes what it computed.",
      "tests/testdata/model_case.json --check");
  command->add_option("case", options->model_case, "JSON file")->required();
  command->add_option("-o,--output", options->output, "JSON file with the computed values");
  command->add_flag("--check", options->check, "compares with the case's expected values");
  command->callback([options, &exit_code] { exit_code = Model(*options); });
}

}  // namespace springgrasp
