#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "base/error.h"
#include "base/files.h"
#include "base/yaml_reader.h"
#include "experiment/experiment.h"
#include "experiment/experiment_criteria.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kTypes = {"pinch", "tripod", "power", "lateral"};

RecordWhich ReadWhich(YamlReader& yaml, const std::string& key, RecordWhich value) {
  std::vector<std::string> names = {"none", "one", "all"};
  if (key == "videos") names.push_back("outcomes");
  std::string name = names[static_cast<std::size_t>(value)];
  yaml.Read(key, name, names);
  return name == "none"  ? RecordWhich::kNone
         : name == "one" ? RecordWhich::kOne
         : name == "all" ? RecordWhich::kAll
                         : RecordWhich::kOutcomes;
}

// A list of some of these names, sorted.
std::vector<std::string> ReadSome(YamlReader& yaml, const std::string& key,
                                  const std::vector<std::string>& allowed) {
  std::vector<std::string> names;
  yaml.Read(key, names);
  for (const std::string& name : names) {
    ThrowUnless(std::find(allowed.begin(), allowed.end(), name) != allowed.end(),
                "{}: {} holds '{}', expected some of {}", yaml.Where(key), key, name,
                fmt::join(allowed, ", "));
  }
  const std::set<std::string> sorted(names.begin(), names.end());
  return {sorted.begin(), sorted.end()};
}

CaseDemonstration ReadCaseDemonstration(YamlReader yaml) {
  CaseDemonstration d;
  yaml.Read("kind", d.kind, {"synthesised", "recorded", "library"});
  yaml.Read("file", d.file);
  yaml.Read("match", d.match);
  yaml.Read("blend", d.blend);
  ThrowUnless(d.blend.empty() || d.kind == "library",
              "{}: blend is between grasps of the library, but kind is {}", yaml.Where("blend"),
              d.kind);
  yaml.Read("part", d.part, {0, 1});
  ThrowUnless(d.kind != "synthesised" || (d.file.empty() && d.match.empty()),
              "{}: file and match are for recorded demonstrations, but kind is synthesised",
              yaml.Where("kind"));
  ThrowUnless(d.kind != "library" || d.match.empty(),
              "{}: match is for recorded demonstrations, but kind is library", yaml.Where("kind"));
  ThrowUnless(d.kind != "recorded" || d.file.empty() != d.match.empty(),
              "{}: a recorded demonstration needs either a file or a match (a pattern such as "
              "pinch_*.csv for the files of the folder `demonstrations`)",
              yaml.Where("kind"));
  yaml.Finish();
  return d;
}

std::vector<SceneOverride> ReadSet(YamlReader yaml) {
  std::vector<SceneOverride> set;
  for (const std::string& key : yaml.Keys()) set.emplace_back(key, yaml.Text(key));
  yaml.Finish();
  return set;
}

std::vector<SampledKey> ReadSample(YamlReader yaml) {
  std::vector<SampledKey> sample;
  for (const std::string& key : yaml.Keys()) {
    std::vector<double> bounds;
    yaml.Read(key, bounds);
    ThrowUnless(bounds.size() == 2 && bounds[0] <= bounds[1],
                "{}: {} is drawn between two numbers, expected [low, high]", yaml.Where(key), key);
    sample.push_back({key, bounds[0], bounds[1]});
  }
  yaml.Finish();
  return sample;
}

ExperimentCondition ReadCondition(YamlReader& yaml) {
  ExperimentCondition condition;
  yaml.Require("name");
  yaml.Read("name", condition.name);
  ThrowUnless(!condition.name.empty(), "{}: a condition needs a name", yaml.Where("name"));
  condition.set = ReadSet(yaml.Child("set"));
  condition.substitute = ReadSome(yaml, "substitute", kSubstitutes);
  condition.sample = ReadSample(yaml.Child("sample"));
  yaml.Finish();
  return condition;
}

ExperimentCase Under(const ExperimentCondition& condition, ExperimentCase c) {
  c.name = fmt::format("{}, {}", c.name, condition.name);
  c.set.insert(c.set.end(), condition.set.begin(), condition.set.end());
  c.substitute.insert(c.substitute.end(), condition.substitute.begin(), condition.substitute.end());
  c.sample.insert(c.sample.end(), condition.sample.begin(), condition.sample.end());
  return c;
}

ExperimentCase ReadCase(YamlReader& yaml) {
  ExperimentCase c;
  yaml.Require("name");
  yaml.Read("name", c.name);
  ThrowUnless(!c.name.empty(), "{}: a case needs a name", yaml.Where("name"));
  yaml.Require("scene");
  yaml.Read("scene", c.scene);
  yaml.Require("grasp");
  yaml.Read("grasp", c.grasp_type, kTypes);
  yaml.Read("until", c.until, {"perform", "observe"});
  yaml.Read("repetitions", c.repetitions, {1, 1000000});
  yaml.Read("dim", c.dim, {2, 3});
  yaml.Read("profile", c.profile, {"human", "paper"});
  yaml.Read("contacts", c.contacts, {"points", "centre"});
  c.substitute = ReadSome(yaml, "substitute", kSubstitutes);
  c.demonstration = ReadCaseDemonstration(yaml.Child("demonstration"));
  c.set = ReadSet(yaml.Child("set"));
  YamlReader variations = yaml.Child("variations");
  for (const std::string& key : variations.Keys()) {
    std::vector<std::string> values;
    variations.Read(key, values);
    ThrowUnless(!values.empty(), "{}: {} varies over an empty list", variations.Where(key), key);
    c.variations.emplace_back(key, values);
  }
  variations.Finish();
  c.sample = ReadSample(yaml.Child("sample"));
  yaml.Read("sampling", c.sampling, {"random", "sobol"});
  yaml.Finish();
  return c;
}

void ReadCriteria(YamlReader yaml, TrialCriteria& criteria) {
  for (const CriterionField& field : kCriterionFields) {
    yaml.Read(field.name, criteria.*field.member, field.bounds);
  }
  yaml.Finish();
}

// The file that a user means by "first_grasps", "experiments/first_grasps" or a YAML's path.
std::string FindExperiment(const std::string& path) {
  ThrowUnless(!path.empty(), "an experiment is a YAML file or a folder holding experiment.yaml");
  std::error_code ignored;
  for (const fs::path& base : {fs::path(path), fs::path(SourceFolder()) / "experiments" / path}) {
    if (fs::is_directory(base, ignored)) return base / "experiment.yaml";
    if (fs::is_regular_file(base, ignored)) return base;
  }
  Fail("{}: no such experiment (a YAML file, or a folder holding experiment.yaml)", path);
}

}  // namespace

Experiment ReadExperiment(const std::string& path, const std::vector<std::string>& overrides) {
  const std::string file = FindExperiment(path);
  return ParseExperiment(ReadFile(file), file, overrides);
}

Experiment ParseExperiment(const std::string& text, const std::string& source,
                           const std::vector<std::string>& overrides) {
  Experiment e;
  e.source = source;
  // Read the file as it is first: its messages then carry the lines that the user sees.
  if (!overrides.empty()) ParseExperiment(text, source);
  std::string effective = text;
  for (const std::string& override_text : overrides) {
    effective = ApplyOverride(effective, override_text);
  }
  YamlReader yaml =
      YamlReader::FromText(effective, overrides.empty() ? source : source + " (with --set)");
  e.text = NormaliseYaml(effective);
  yaml.Require("name");
  yaml.Read("name", e.name);
  double seed = 0;
  yaml.Require("seed");
  yaml.Read("seed", seed, {0, 9007199254740992.0});
  ThrowUnless(seed == std::floor(seed), "{}: seed is {}, expected a whole number",
              yaml.Where("seed"), seed);
  e.seed = static_cast<std::uint64_t>(seed);
  yaml.Read("repetitions", e.repetitions, {1, 1000000});
  yaml.Read("demonstrations", e.demonstrations);
  e.baselines = ReadSome(yaml, "baselines", kBaselines);
  e.substitute = ReadSome(yaml, "substitute", kSubstitutes);
  ReadCriteria(yaml.Child("criteria"), e.criteria);
  YamlReader record = yaml.Child("record");
  e.record.videos = ReadWhich(record, "videos", e.record.videos);
  e.record.overlays = ReadWhich(record, "overlays", e.record.overlays);
  e.record.trajectories = ReadWhich(record, "trajectories", e.record.trajectories);
  record.Finish();
  yaml.Require("cases");
  std::vector<ExperimentCondition> conditions;
  std::set<std::string> names;
  for (YamlReader& child : yaml.Children("conditions")) {
    conditions.push_back(ReadCondition(child));
    ThrowUnless(names.insert(conditions.back().name).second, "{}: a second condition is named '{}'",
                child.Where("name"), conditions.back().name);
  }
  names.clear();
  for (YamlReader& child : yaml.Children("cases")) {
    const ExperimentCase c = ReadCase(child);
    ThrowUnless(names.insert(c.name).second, "{}: a second case is named '{}'", child.Where("name"),
                c.name);
    if (conditions.empty()) e.cases.push_back(c);
    for (const ExperimentCondition& condition : conditions) e.cases.push_back(Under(condition, c));
  }
  ThrowUnless(!e.cases.empty(), "{}: an experiment needs at least one case", yaml.Where("cases"));
  yaml.Finish();
  return e;
}

}  // namespace springgrasp
