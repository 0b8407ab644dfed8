// What storing one trial costs, and exporting ten thousand.
#include <benchmark/benchmark.h>

#include <filesystem>

#include "experiment/export.h"
#include "experiment/store.h"

namespace springgrasp {
namespace {

RunDescription Plan(int n) {
  RunDescription run{"name: bench\n", "", "", {}};
  for (int i = 0; i < n; ++i) {
    run.plan.push_back({fmt::format("{:016x}", i), "case", "synthesised", "none", i, 1, ""});
  }
  return run;
}

TrialResult ResultWithFiftyValues() {
  TrialResult result;
  for (int i = 0; i < 50; ++i) result.values[fmt::format("value_{}", i)] = i / 3.0;
  return result;
}

std::string FreshFolder() {
  const auto folder = std::filesystem::temp_directory_path() / "springgrasp_store_bench";
  std::filesystem::remove_all(folder);
  return folder.string();
}

void StoreOneTrial(benchmark::State& state) {
  constexpr int kPlanned = 100000;
  const RunDescription run = Plan(kPlanned);
  const std::string folder = FreshFolder();
  {
    ResultStore store = ResultStore::OpenForRun(folder, run);
    const TrialResult result = ResultWithFiftyValues();
    std::size_t i = 0;
    for (auto _ : state) store.Add(run.plan.at(i++).id, result);
  }
  std::filesystem::remove_all(folder);
}
BENCHMARK(StoreOneTrial)->Iterations(500);

void ExportTenThousandTrials(benchmark::State& state) {
  std::vector<StoredTrial> trials;
  for (const PlanRow& row : Plan(10000).plan) trials.push_back({row, ResultWithFiftyValues()});
  for (auto _ : state) benchmark::DoNotOptimize(ExportCsv(trials, false));
}
BENCHMARK(ExportTenThousandTrials)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace springgrasp
