// The results directory: results.sqlite (README, "Results"), experiment.yaml, provenance, and one
// folder per recorded trial. Knows nothing of MuJoCo.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "experiment/store_sqlite.h"
#include "experiment/trial_result.h"

namespace springgrasp {

// Raised by hand when the same parameters would give another outcome than before.
inline constexpr int kBehaviourVersion = 14;
// Raised when the tables change.
inline constexpr int kSchemaVersion = 2;

// The directory holds results of another experiment or another behaviour version (exit code 4).
class ForeignDirectory : public Error {
 public:
  using Error::Error;
};

// What the store keeps of a planned trial.
struct PlanRow {
  std::string id;
  std::string case_name;
  std::string demonstration;
  std::string baseline = "none";
  int repetition = 0;
  std::uint64_t seed = 0;
  std::string parameters;  // CanonicalText
};

// What a directory is opened for.
struct RunDescription {
  std::string experiment_yaml;  // effective
  std::string source;           // absolute path of the file that it was read from
  std::string provenance;
  std::vector<PlanRow> plan;
};

struct StoredTrial {
  PlanRow plan;
  std::optional<TrialResult> result;  // absent: not run yet
};

class ResultStore {
 public:
  // Opens `directory` for these trials, creating it if need be. Throws ForeignDirectory if it
  // holds others, Error if it cannot be written, is no results directory and not empty, or another
  // run is using it. Nothing is changed in either case.
  static ResultStore OpenForRun(const std::string& directory, const RunDescription& run);
  // Throws Error if `directory` holds no results.
  static ResultStore OpenForReading(const std::string& directory);

  ResultStore(ResultStore&&) noexcept = default;
  ~ResultStore();

  std::set<std::string> FinishedIds();
  // One transaction. A second result of the same trial replaces nothing and throws Error.
  void Add(const std::string& id, const TrialResult& result);
  // A row of the table `meta`; empty if there is none.
  std::string Meta(const std::string& key);
  // All planned trials in the order of the plan, with wall times.
  std::vector<StoredTrial> Trials();

  const std::string& directory() const { return directory_; }

 private:
  ResultStore(std::string directory, Database::Mode mode);
  void CheckVersions();

  struct Lock;  // held while a run writes
  std::string directory_;
  std::shared_ptr<Lock> lock_;
  std::unique_ptr<Database> database_;
};

}  // namespace springgrasp
