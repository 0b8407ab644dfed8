#include <fnmatch.h>

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <boost/random/uniform_01.hpp>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/files.h"
#include "base/random.h"
#include "base/yaml_reader.h"
#include "demonstration/demonstration.h"
#include "experiment/experiment.h"
#include "experiment/observation_key.h"
#include "experiment/trial_identity.h"
#include "grasp/library.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

// A file that an experiment names: absolute, beside the experiment, or in a shipped folder.
std::string FindNamed(const std::string& name, const Experiment& e, const char* shipped_folder) {
  std::error_code ignored;
  const fs::path beside = fs::path(e.source).parent_path() / name;
  const fs::path shipped = fs::path(SourceFolder()) / shipped_folder / name;
  for (const fs::path& path : {beside, shipped}) {
    if (fs::exists(path, ignored)) return fs::absolute(path).lexically_normal();
  }
  Fail("{}: there is no '{}' beside the experiment or in {}", e.source, name,
       shipped.parent_path().string());
}

std::vector<std::string> FilesOf(const Experiment& e, const ExperimentCase& c) {
  if (c.demonstration.kind != "recorded") return {""};
  if (!c.demonstration.file.empty()) return {FindNamed(c.demonstration.file, e, "experiments")};
  ThrowUnless(!e.demonstrations.empty(),
              "{}: case '{}' takes recordings from a folder; say which, for example "
              "--set demonstrations=path/to/folder",
              e.source, c.name);
  const std::string folder = FindNamed(e.demonstrations, e, "experiments");
  ThrowUnless(fs::is_directory(folder), "{}: not a folder of demonstrations", folder);
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (fnmatch(c.demonstration.match.c_str(), name.c_str(), FNM_PERIOD) == 0) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  ThrowUnless(!files.empty(), "{}: no file matches '{}' (case '{}' of {})", folder,
              c.demonstration.match, c.name, e.source);
  return files;
}

// "pinch_20mm_1" -> "0.020"
std::string DepthInName(const std::string& name) {
  const auto unit = name.find("mm");
  std::size_t begin = unit;
  while (unit != std::string::npos && begin > 0 && std::isdigit(name[begin - 1]) != 0) --begin;
  ThrowUnless(
      unit != std::string::npos && begin < unit,
      "{{depth}} is asked for, but the recording's name '{}' holds no number followed by mm", name);
  return fmt::format("{:.3f}", 1e-3 * std::stod(name.substr(begin, unit - begin)));
}

std::string FillIn(std::string value, const std::string& demonstration) {
  const std::string placeholder = "{depth}";
  for (auto at = value.find(placeholder); at != std::string::npos; at = value.find(placeholder)) {
    value.replace(at, placeholder.size(), DepthInName(demonstration));
  }
  return value;
}

// Every combination of the values of the varied keys.
std::vector<std::vector<SceneOverride>> Conditions(const ExperimentCase& c) {
  std::vector<std::vector<SceneOverride>> conditions = {{}};
  for (const auto& [key, values] : c.variations) {
    std::vector<std::vector<SceneOverride>> next;
    for (const auto& condition : conditions) {
      for (const std::string& value : values) {
        next.push_back(condition);
        next.back().emplace_back(key, value);
      }
    }
    conditions = std::move(next);
  }
  return conditions;
}

std::string Hash(const std::string& file) {
  return fmt::format("{:016x}", HashText(ReadFile(file)));
}

// Scene and canonical text of one condition with one demonstration.
void BuildScene(const Experiment& e, const ExperimentCase& c,
                const std::vector<SceneOverride>& condition, const std::string& file,
                TrialSpec& spec) {
  const std::string path = FindNamed(c.scene, e, "scenes");
  std::string text = ReadFile(path);
  ParseScene(text, path);  // messages with the lines of the file
  std::vector<SceneOverride> overrides = c.set;
  overrides.insert(overrides.end(), condition.begin(), condition.end());
  overrides.emplace_back("demonstrator.kind", file.empty() ? "synthesised" : "recorded");
  overrides.emplace_back("demonstrator.type", c.grasp_type);
  for (const auto& [key, value] : overrides) {
    text = ApplyOverride(text, key + "=" + FillIn(value, spec.demonstration));
  }
  const std::string key = "demonstrator.file=";
  spec.scene_text = file.empty() ? text : ApplyOverride(text, key + Hash(file));
  if (!file.empty()) text = ApplyOverride(text, key + "'" + file + "'");
  spec.scene = ParseScene(text, path);
  ThrowUnless(!spec.scene.objects.empty(), "{}: the scene has no object to grasp", path);
  for (const SceneObject& object : spec.scene.objects) {
    if (!object.model.empty()) {
      spec.scene_text += fmt::format("model of {}: {}\n", object.name, Hash(object.model));
    }
  }
  if (!file.empty()) ReadDemonstration(file);
}

// The entry that a case performs in place of one learned from its own demonstration.
void UseLibrary(const Experiment& e, const ExperimentCase& c, TrialSpec& spec) {
  ThrowUnless(c.until == "perform",
              "{}: case '{}' takes its grasp from the library, so that nothing is observed; until "
              "is '{}', expected perform",
              e.source, c.name, c.until);
  const std::string& file = c.demonstration.file;
  spec.demonstration = "library";
  spec.grasp_file = file.empty() ? (fs::path(ShippedLibrary()) / (c.grasp_type + ".yaml")).string()
                                 : FindNamed(file, e, "models/grasps");
  spec.grasp_hash = Hash(spec.grasp_file);
  std::string nearer = spec.grasp_file;
  if (!c.demonstration.blend.empty()) {
    spec.blend_file = FindNamed(c.demonstration.blend, e, "models/grasps");
    spec.blend_part = c.demonstration.part;
    spec.grasp_hash += fmt::format(" {} of the way to {}", spec.blend_part, Hash(spec.blend_file));
    if (spec.blend_part >= 0.5) nearer = spec.blend_file;
  }
  const std::string type = ReadGrasp(nearer).type;
  ThrowUnless(type == c.grasp_type, "{}: a {} grasp, but case '{}' of {} is a {}", nearer, type,
              c.name, e.source, c.grasp_type);
  const std::string shown = DemonstrationOfEntry(spec.grasp_file);
  const std::vector<std::string>& b = e.baselines;
  std::error_code ignored;
  if (fs::exists(shown, ignored)) {
    spec.grasp_hash += Hash(shown);
  } else {
    ThrowUnless(
        std::find(b.begin(), b.end(), "playback") == b.end(),
        "{}: the baseline playback needs the demonstration that this grasp was learned from "
        "as {}",
        spec.grasp_file, shown);
  }
  ThrowUnless(std::find(b.begin(), b.end(), "open_hand") == b.end(),
              "{}: the baseline open_hand learns from its own demonstration, but case '{}' takes "
              "its grasp from the library",
              e.source, c.name);
}

// `condition` with the values that one repetition drew.
std::vector<SceneOverride> WithSample(const Experiment& e, const ExperimentCase& c,
                                      std::vector<SceneOverride> condition, TrialSpec& spec) {
  const std::vector<double> values = DrawSample(c, e.seed, spec.repetition);
  spec.drawn.clear();
  for (std::size_t i = 0; i < values.size(); ++i) {
    spec.drawn.emplace_back(c.sample[i].key, values[i]);
    condition.emplace_back(c.sample[i].key, fmt::format("{}", values[i]));
  }
  return condition;
}

bool Wanted(RecordWhich which, bool first) {
  return which == RecordWhich::kAll || (which == RecordWhich::kOne && first);
}

// All repetitions of one condition with one demonstration.
std::vector<PlannedTrial> TrialsOf(const Experiment& e, const ExperimentCase& c,
                                   const std::vector<SceneOverride>& condition,
                                   const std::string& file) {
  TrialSpec spec;
  spec.demonstration = file.empty() ? "synthesised" : fs::path(file).stem().string();
  if (c.demonstration.kind == "library") UseLibrary(e, c, spec);
  spec.grasp_type = c.grasp_type;
  spec.until = c.until;
  spec.dim = c.dim;
  spec.profile = c.profile;
  spec.object_centre = c.contacts == "centre";
  spec.criteria = e.criteria;
  std::set<std::string> substitute(e.substitute.begin(), e.substitute.end());
  substitute.insert(c.substitute.begin(), c.substitute.end());
  spec.substitute.assign(substitute.begin(), substitute.end());
  spec.seed = e.seed;
  std::vector<PlannedTrial> trials;
  const int repetitions = c.repetitions > 0 ? c.repetitions : e.repetitions;
  for (int r = 0; r < repetitions; ++r) {
    spec.repetition = r;
    if (r == 0 || !c.sample.empty()) {
      BuildScene(e, c, WithSample(e, c, condition, spec), file, spec);
    }
    std::vector<std::string> baselines = {"none"};
    if (c.until == "perform") {
      baselines.insert(baselines.end(), e.baselines.begin(), e.baselines.end());
    }
    for (const std::string& baseline : baselines) {
      spec.baseline = baseline;
      PlannedTrial trial{TrialIdentity(spec), spec, {}};
      trial.group = HashText(ObservationKey(spec));
      const bool first = r == 0 && baseline == "none";
      trial.output.video = Wanted(e.record.videos, first);
      trial.output.overlay = Wanted(e.record.overlays, first);
      trial.output.trajectories = Wanted(e.record.trajectories, first);
      trials.push_back(std::move(trial));
    }
  }
  return trials;
}

}  // namespace

std::vector<double> DrawSample(const ExperimentCase& c, std::uint64_t seed, int repetition) {
  std::vector<double> values;
  if (c.sample.empty()) return values;
  const bool sobol = c.sampling == "sobol";
  boost::random::sobol sequence(c.sample.size());
  sequence.discard(static_cast<std::uintmax_t>(repetition) * c.sample.size());
  boost::random::uniform_01<double> unit;
  for (const SampledKey& key : c.sample) {
    RandomEngine engine =
        MakeStream(seed, static_cast<std::uint64_t>(sobol ? 0 : repetition), "sample " + key.key);
    double u = Uniform01(engine);
    if (sobol) u = std::fmod(u + unit(sequence), 1);
    values.push_back(key.low + u * (key.high - key.low));
  }
  return values;
}

std::vector<PlannedTrial> ExpandExperiment(const Experiment& e) {
  std::vector<PlannedTrial> trials;
  std::map<std::string, std::string> owner;  // identity -> case
  for (const ExperimentCase& c : e.cases) {
    const std::vector<std::string> files = FilesOf(e, c);
    for (const auto& condition : Conditions(c)) {
      std::string name = c.name;
      for (const auto& [key, value] : condition) name += fmt::format(" {}={}", key, value);
      for (const std::string& file : files) {
        for (PlannedTrial& trial : TrialsOf(e, c, condition, file)) {
          trial.spec.case_name = name;
          const auto [entry, is_new] = owner.emplace(trial.id, name);
          ThrowUnless(is_new, "{}: cases '{}' and '{}' hold the same trial", e.source,
                      entry->second, name);
          trials.push_back(std::move(trial));
        }
      }
    }
  }
  return trials;
}

}  // namespace springgrasp
