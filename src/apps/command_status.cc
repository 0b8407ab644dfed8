// springgrasp status: how far a results directory is.
#include <fmt/format.h>

#include <memory>

#include "apps/command.h"
#include "experiment/store.h"
#include "experiment/table.h"

namespace springgrasp {
namespace {

int Status(const std::string& directory) {
  const std::vector<StoredTrial> trials = ResultStore::OpenForReading(directory).Trials();
  int done = 0, succeeded = 0, diverged = 0, errors = 0;
  std::vector<std::string> reasons;
  for (const StoredTrial& trial : trials) {
    if (!trial.result) continue;
    ++done;
    const Outcome outcome = trial.result->outcome;
    succeeded += outcome == Outcome::kSuccess;
    diverged += outcome == Outcome::kDiverged;
    if (outcome == Outcome::kError) {
      ++errors;
      reasons.push_back(fmt::format("error in {}: {}", trial.plan.id, trial.result->message));
    }
  }
  fmt::print("done {}  succeeded {}  failed {}  diverged {}  error {}  missing {}\n\n{}", done,
             succeeded, done - succeeded - diverged - errors, diverged, errors,
             trials.size() - static_cast<std::size_t>(done), OutcomeTable(trials));
  const std::string recordings = RecordingTable(trials);
  if (!recordings.empty()) fmt::print("\n{}", recordings);
  for (const std::string& reason : reasons) fmt::print("{}\n", reason);
  return kDone;
}

}  // namespace

void AddStatusCommand(CLI::App& app, int& exit_code) {
  auto directory = std::make_shared<std::string>();
  CLI::App* command = AddCommand(app, "status", "Says what is done, failed, diverged and missing.",
                                 "out/first_grasps");
  command->add_option("directory", *directory, "results directory of `run`")->required();
  command->callback([directory, &exit_code] { exit_code = Status(*directory); });
}

}  // namespace springgrasp
