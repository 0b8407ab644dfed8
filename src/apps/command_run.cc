// springgrasp run: every trial of an experiment, from demonstration to outcome.
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/command.h"
#include "apps/progress.h"
#include "base/error.h"
#include "experiment/film_outcomes.h"
#include "experiment/runner.h"
#include "experiment/table.h"
#include "experiment/trial.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string experiment;
  std::string directory;
  int jobs = 1;
  int limit = -1;
  std::vector<std::string> overrides;
  bool quiet = false;
};

volatile sig_atomic_t stop_requested = 0;

// The first signal asks for a clean end, a second one ends at once.
void OnSignal(int number) {
  stop_requested = 1;
  signal(number, SIG_DFL);
}

// A folder given on the command line is meant from where the user stands, not from the file.
std::string MakeFolderAbsolute(const std::string& override_text) {
  const std::string key = "demonstrations=";
  if (override_text.rfind(key, 0) != 0) return override_text;
  const std::string folder = override_text.substr(key.size());
  std::error_code ignored;
  ThrowUnless(fs::is_directory(folder, ignored), "--set {}: no such folder", override_text);
  return key + "'" + fs::canonical(folder).string() + "'";
}

// Where the videos and pictures of a trial lie, one line for each.
void PrintPictures(const StoredTrial& trial, const std::string& directory) {
  std::vector<std::string> files;
  std::error_code ignored;
  for (const auto& entry :
       fs::directory_iterator(fs::path(directory) / "trials" / trial.plan.id, ignored)) {
    const auto extension = entry.path().extension();
    if (extension == ".mp4" || extension == ".png") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::string name = CaseLabel(trial.plan);
  if (IsRecording(trial.plan)) name += " " + trial.plan.demonstration;
  for (const std::string& file : files) fmt::print("{}: {}\n", name, file);
}

void PrintResults(ResultStore& store) {
  const std::vector<StoredTrial> trials = store.Trials();
  fmt::print("{}", OutcomeTable(trials));
  const std::string recordings = RecordingTable(trials);
  if (!recordings.empty()) fmt::print("\n{}", recordings);
  fmt::print("\nresults: {}\n", (fs::path(store.directory()) / "results.sqlite").string());
  for (const StoredTrial& trial : trials) PrintPictures(trial, store.directory());
}

int Run(Options options) {
  for (std::string& text : options.overrides) text = MakeFolderAbsolute(text);
  const Experiment experiment = ReadExperiment(options.experiment, options.overrides);
  const std::vector<PlannedTrial> trials = ExpandExperiment(experiment);
  ResultStore store = ResultStore::OpenForRun(options.directory, DescribeRun(experiment, trials));
  RunOptions run;
  run.jobs = options.jobs;
  run.limit = options.limit;
  run.stop_requested = [] { return stop_requested != 0; };
  signal(SIGINT, OnSignal);
  signal(SIGTERM, OnSignal);
  RunEnd end;
  {
    ProgressPrinter printer(options.quiet);
    run.on_progress = [&printer](const RunProgress& progress) { printer(progress); };
    auto memory = std::make_shared<TrialMemory>();  // of each worker process its own
    end = RunTrials(
        trials, store,
        [memory](const TrialSpec& spec, const TrialOutput& output) {
          return RunTrialWith(*memory, spec, output);
        },
        run);
  }
  if (end == RunEnd::kComplete && experiment.record.videos == RecordWhich::kOutcomes) {
    const std::vector<StoredTrial> stored = store.Trials();
    const auto film = TrialsToFilm(trials, stored, store.directory());
    if (!FilmTrials(film, stored, store.directory(), RunTrial, run.stop_requested)) {
      end = RunEnd::kStoppedEarly;
    }
  }
  if (!options.quiet) PrintResults(store);
  return end == RunEnd::kComplete ? kDone : kStoppedEarly;
}

}  // namespace

void AddRunCommand(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      AddCommand(app, "run", "Runs every trial of an experiment; resumes a stopped directory.",
                 "experiments/first_grasps -o out/first_grasps --jobs 2");
  command
      ->add_option("experiment", options->experiment,
                   "YAML file, or a folder that holds experiment.yaml")
      ->required();
  command->add_option("-o,--output", options->directory, "directory for the results")->required();
  command->add_option("--jobs", options->jobs, "worker processes")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command
      ->add_option("--set", options->overrides,
                   "overrides one value of the experiment, key=value with a dotted path; may be "
                   "given several times")
      ->allow_extra_args(false);
  command->add_option("--limit", options->limit, "runs at most so many trials now")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--quiet", options->quiet, "no progress, no table");
  command->callback([options, &exit_code] { exit_code = Run(*options); });
}

}  // namespace springgrasp
