// EXPERIMENT: scenes x demonstrations x grasps x variations x repetitions, and what to record.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "experiment/phases.h"
#include "experiment/trial_spec.h"

namespace springgrasp {

// Which trials of a condition leave a file: none, repetition 0, or all; videos also: the first
// success and the first failure, filmed once the run is over.
enum class RecordWhich { kNone, kOne, kAll, kOutcomes };

struct RecordOptions {
  RecordWhich videos = RecordWhich::kNone;
  RecordWhich overlays = RecordWhich::kNone;
  RecordWhich trajectories = RecordWhich::kOne;
};

// A value of the scene that each repetition draws anew, between two bounds. The draws of a key are
// the same in all cases and conditions.
struct SampledKey {
  std::string key;  // dotted path into the scene's YAML
  double low = 0, high = 0;
};

// Where the demonstrations of a case come from.
struct CaseDemonstration {
  std::string kind = "synthesised";  // synthesised | recorded | library: learned already
  std::string file;   // recorded: one CSV; library: a grasp YAML, empty: the shipped one ...
  std::string match;  // ... or all of the experiment's folder that match this glob pattern
  // Library: the grasp at `part` (0 to 1) of the way to this other one; empty: the first itself.
  std::string blend;
  double part = 0.5;
};

// `key=value` with a dotted path into the scene's YAML. `{depth}` in a value stands for the
// number before `mm` in the name of the recording, in metres.
using SceneOverride = std::pair<std::string, std::string>;

struct ExperimentCase {
  std::string name;
  std::string scene;              // file beside the experiment, else under scenes/, else absolute
  std::string grasp_type;         // pinch | tripod | power | lateral
  std::string until = "perform";  // perform | observe: tracked, not learned
  int dim = 3;
  std::string profile = "human";
  std::string contacts = "points";      // points | centre (Eq. (6) alone)
  int repetitions = 0;                  // 0: the experiment's
  std::vector<std::string> substitute;  // beside the experiment's
  CaseDemonstration demonstration;
  std::vector<SceneOverride> set;
  // Grid: every combination of the values of each scene key is a condition of its own.
  std::vector<std::pair<std::string, std::vector<std::string>>> variations;
  std::vector<SampledKey> sample;
  std::string sampling = "random";  // random | sobol: a sequence that fills the space evenly
};

// What every case is tried under: `set`, `substitute` and `sample` beside the case's own.
struct ExperimentCondition {
  std::string name;  // the trials' case is called "CASE, NAME"
  std::vector<SceneOverride> set;
  std::vector<std::string> substitute;
  std::vector<SampledKey> sample;
};

// The values of one repetition, in the order of c.sample. Sobol: point `repetition` of the
// sequence, each coordinate turned by an offset of its own (Cranley-Patterson), from seed and key.
std::vector<double> DrawSample(const ExperimentCase& c, std::uint64_t seed, int repetition);

struct Experiment {
  std::string source;  // file, for messages and for finding scenes beside it
  std::string text;    // effective YAML, overrides applied, comments dropped
  std::string name;
  std::uint64_t seed = 0;
  int repetitions = 1;
  std::string demonstrations;           // folder of recordings; empty: none needed
  std::vector<std::string> baselines;   // every trial that performs also by each of these
  std::vector<std::string> substitute;  // in all cases
  TrialCriteria criteria;
  RecordOptions record;
  std::vector<ExperimentCase> cases;  // each under each of the conditions
};

// `path`: a YAML file, or a folder that holds experiment.yaml; where there is none, the same below
// the folder of shipped experiments. Overrides are `key=value` with dotted paths. Throws Error.
Experiment ReadExperiment(const std::string& path, const std::vector<std::string>& overrides = {});
Experiment ParseExperiment(const std::string& text, const std::string& source,
                           const std::vector<std::string>& overrides = {});

struct PlannedTrial {
  std::string id;  // TrialIdentity(spec)
  TrialSpec spec;
  TrialOutput output;  // what to record; folder still empty
  // Trials of one group are faster one after the other in one process (ObservationKey's hash).
  std::uint64_t group = 0;
};

// Every trial, in the order of the file: cases, conditions, demonstrations, repetitions, the open
// hand right after its trial. Reads all scenes and demonstrations, so bad input shows here. Throws
// Error, also if two cases hold the same trial.
std::vector<PlannedTrial> ExpandExperiment(const Experiment& experiment);

}  // namespace springgrasp
