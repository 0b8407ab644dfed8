// The bare mathematics against reference files, and what malformed files are answered.
#include "grasp/model_case.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "base/error.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

Json SmallCase() {
  return Json::parse(R"({
    "format": "fingertip-springs-golden-1", "name": "small", "kind": "trajectory",
    "params": {"N": 2, "dim": 2, "edges": [[0, 1]], "k": [1.0], "l": [0.05], "d": [0.1],
               "m": [0.02, 0.02], "anchors": [[-0.02, 0.0], [0.02, 0.0]], "involved": [1, 1],
               "kc": 1.0, "dc": 0.3, "L": [0.0, 0.0], "d0": 0.0, "eps_s": 1e-6, "eps_c": 1e-3,
               "Rmax": null, "damping": "axial", "direction": "surface", "ratio": "paper",
               "fcen": {"type": "sine", "amplitude": 0.01, "period": 1.0}},
    "initial": {"p": [[-0.05, 0.0], [0.05, 0.01]], "v": [[0.0, 0.0], [0.0, 0.0]]},
    "tolerance": {"p": 1e-9, "v": 1e-8},
    "expected": {"t": [0.0, 0.1, 0.2]}})");
}

std::string ErrorOf(const Json& model_case) {
  try {
    EvaluateModelCase(model_case, "small.json");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ModelCase, EveryGoldenFilePassesAtItsOwnTolerance) {
  const fs::path folder = fs::path(SPRINGGRASP_SHARED_DIR) / "golden";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "no reference files: " << folder << " is absent";
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.insert(entry.path());
  }
  EXPECT_GE(files.size(), 10u);
  for (const fs::path& file : files) {
    const Json model_case = ReadModelCase(file.string());
    const Json computed = EvaluateModelCase(model_case, file.filename().string());
    const ModelCaseCheck check = CheckModelCase(model_case, computed, file.filename().string());
    for (const auto& entry : check.entries) {
      EXPECT_LE(entry.error, entry.tolerance) << file.filename() << ": " << entry.key;
    }
    EXPECT_TRUE(check.passed) << file.filename();
    RecordProperty(file.stem().string(), std::to_string(check.worst_ratio));
  }
}

TEST(ModelCase, OfExpectedOnlyWhatIsInputIsRead) {
  const fs::path folder = fs::path(SPRINGGRASP_SHARED_DIR) / "golden";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "no reference files: " << folder << " is absent";
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") continue;
    const Json full = ReadModelCase(entry.path().string());
    Json bare = full;
    const std::string kind = full.at("kind");
    if (kind == "rhs") {
      for (Json& state : bare["expected"]) {
        state = {{"p", state["p"]}, {"v", state["v"]}, {"f", state["f"]}};
      }
    } else if (kind == "trajectory" || kind == "dmp_rollout") {
      bare["expected"] = {{"t", full["expected"]["t"]}};
    } else {
      bare.erase("expected");
    }
    if (kind == "dmp_learn") bare["params"].erase("weights");
    EXPECT_EQ(EvaluateModelCase(bare, "bare"), EvaluateModelCase(full, "full")) << entry.path();
  }
}

TEST(ModelCase, ComparingWithItselfGivesNoErrorAndAChangeIsFound) {
  Json model_case = SmallCase();
  const Json computed = EvaluateModelCase(model_case, "small.json");
  model_case["expected"] = computed;
  EXPECT_EQ(CheckModelCase(model_case, computed, "small.json").worst_ratio, 0);
  model_case["expected"]["p"][2][1][0] = computed["p"][2][1][0].get<double>() + 5e-9;
  const ModelCaseCheck check = CheckModelCase(model_case, computed, "small.json");
  EXPECT_FALSE(check.passed);
  EXPECT_EQ(check.worst_key, "p");
  EXPECT_NEAR(check.worst_ratio, 5.0, 1e-3);
}

// Every number in turn, changed by a thousandth, must be noticed in its key.
void ExpectEveryKeyCounts(Json& model_case, Json& part, const Json& computed,
                          const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    Json* value = &part[key];
    while (value->is_array()) value = &value->back();
    const Json before = *value;
    *value = before.get<double>() * 1.001 + 1e-3;
    const ModelCaseCheck check = CheckModelCase(model_case, computed, "changed");
    EXPECT_FALSE(check.passed) << key;
    EXPECT_EQ(check.worst_key, key);
    *value = before;
  }
}

TEST(ModelCase, EveryExpectedKeyIsCompared) {
  const fs::path folder = fs::path(SPRINGGRASP_SHARED_DIR) / "golden";
  if (!fs::is_directory(folder)) GTEST_SKIP() << "no reference files: " << folder << " is absent";
  const std::vector<std::pair<std::string, std::vector<std::string>>> keys = {
      {"springs_2d_free.json", {"p", "v"}},
      {"dmp_rollout.json", {"x", "v", "a"}},
      {"dmp_learn.json", {"weights"}},
      {"fcen_skewed.json", {"t_switch", "f"}},
      {"kest_2d_fan7.json", {"k", "first_frame_rows_X", "first_frame_rhs", "singular_values"}},
      {"rhs_3d_object.json", {"x", "xdot", "xc", "s", "u", "R", "acc"}}};
  for (const auto& [file, names] : keys) {
    Json model_case = ReadModelCase((folder / file).string());
    const Json computed = EvaluateModelCase(model_case, file);
    Json& expected = model_case["expected"];
    ExpectEveryKeyCounts(model_case, expected.is_array() ? expected[3] : expected, computed, names);
  }
}

TEST(ModelCase, MalformedCasesNameFileAndKey) {
  Json c = SmallCase();
  c["params"].erase("kc");
  EXPECT_THAT(ErrorOf(c), AllOf(HasSubstr("small.json"), HasSubstr("'kc' is missing")));
  c = SmallCase();
  c["params"]["k"] = {1.0, 2.0};
  EXPECT_THAT(ErrorOf(c), AllOf(HasSubstr("small.json"), HasSubstr("params.k")));
  c = SmallCase();
  c["params"]["m"][1] = -0.02;
  EXPECT_THAT(ErrorOf(c), HasSubstr("params.m[1]"));
  c = SmallCase();
  c["params"]["edges"][0] = {0, 7};
  EXPECT_THAT(ErrorOf(c), HasSubstr("params.edges[0][1]"));
  c = SmallCase();
  c["params"]["damping"] = "sticky";
  EXPECT_THAT(ErrorOf(c), AllOf(HasSubstr("params.damping"), HasSubstr("axial, vector, literal")));
  c = SmallCase();
  c["expected"]["t"] = {0.0, 0.2, 0.1};
  EXPECT_THAT(ErrorOf(c), AllOf(HasSubstr("expected.t"), HasSubstr("increase")));
  c = SmallCase();
  c["initial"]["p"][0] = {0.0, 0.0, 0.0};
  EXPECT_THAT(ErrorOf(c), HasSubstr("initial.p[0]"));
  c = SmallCase();
  c["kind"] = "dance";
  EXPECT_THAT(ErrorOf(c), AllOf(HasSubstr("kind"), HasSubstr("dmp_rollout")));
  EXPECT_THAT(ErrorOf(Json::parse("[1, 2]")), HasSubstr("small.json"));
  EXPECT_THROW(ReadModelCase("/nonexistent/case.json"), Error);
}

}  // namespace
}  // namespace springgrasp
