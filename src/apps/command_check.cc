// springgrasp check: holds results against an expectation file.
#include <fmt/format.h>

#include <memory>

#include "apps/command.h"
#include "base/files.h"
#include "experiment/expectation.h"

namespace springgrasp {

void AddCheckCommand(CLI::App& app, int& exit_code) {
  struct Options {
    std::string directory, expectation;
    bool record = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "check",
                 "Compares outcome rates (lower 95 % Wilson bound) and errors with an expectation "
                 "file; ends with 1 where one falls short.",
                 "out/first_grasps experiments/first_grasps/expect.yaml");
  command->add_option("directory", options->directory, "results directory of `run`")->required();
  command->add_option("expectation", options->expectation, "YAML file")->required();
  command->add_flag("--record", options->record, "writes the file from these results instead");
  command->callback([options, &exit_code] {
    const std::vector<StoredTrial> trials =
        ResultStore::OpenForReading(options->directory).Trials();
    if (options->record) {
      CheckOutputPath(options->expectation);
      MakeFolderOf(options->expectation);
      WriteFileAtomically(options->expectation, RecordExpectation(trials));
      exit_code = kDone;
      return;
    }
    const CheckReport report = CheckExpectation(ReadExpectation(options->expectation), trials);
    fmt::print("{}", report.table);
    exit_code = report.ok ? kDone : kCheckFailed;
  });
}

}  // namespace springgrasp
