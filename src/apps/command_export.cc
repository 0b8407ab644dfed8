// springgrasp export: results as CSV.
#include <memory>

#include "apps/command.h"
#include "base/files.h"
#include "experiment/export.h"

namespace springgrasp {

void AddExportCommand(CLI::App& app, int& exit_code) {
  struct Options {
    std::string directory, output;
    bool timings = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "export", "Writes one CSV row per finished trial, sorted by trial identity.",
                 "out/first_grasps -o out/first_grasps.csv");
  command->add_option("directory", options->directory, "results directory of `run`")->required();
  command->add_option("-o,--output", options->output, "CSV file")->required();
  command->add_flag("--timings", options->timings, "adds wall times (not reproducible)");
  command->callback([options, &exit_code] {
    CheckOutputPath(options->output);
    ResultStore store = ResultStore::OpenForReading(options->directory);
    MakeFolderOf(options->output);
    WriteFileAtomically(options->output, ExportCsv(store.Trials(), options->timings));
    exit_code = kDone;
  });
}

}  // namespace springgrasp
