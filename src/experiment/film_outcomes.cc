#include "experiment/film_outcomes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/files.h"
#include "experiment/replay.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

fs::path VideoOf(const std::string& directory, const std::string& id) {
  return fs::path(directory) / "trials" / id / "grasp.mp4";
}

}  // namespace

std::vector<PlannedTrial> TrialsToFilm(const std::vector<PlannedTrial>& planned,
                                       const std::vector<StoredTrial>& stored,
                                       const std::string& directory) {
  std::vector<PlannedTrial> film;
  std::set<std::pair<std::string, bool>> seen;  // condition (with its baseline), success
  for (const StoredTrial& trial : stored) {
    if (!trial.result) continue;
    const auto plan = std::find_if(planned.begin(), planned.end(),
                                   [&](const PlannedTrial& p) { return p.id == trial.plan.id; });
    if (plan == planned.end() || plan->spec.until != "perform") continue;
    const std::string condition = fmt::format("{}/{}", trial.plan.case_name, trial.plan.baseline);
    if (!seen.insert({condition, trial.result->outcome == Outcome::kSuccess}).second) continue;
    if (!fs::exists(VideoOf(directory, plan->id))) film.push_back(*plan);
  }
  return film;
}

bool FilmTrials(const std::vector<PlannedTrial>& trials, const std::vector<StoredTrial>& stored,
                const std::string& directory, const TrialFunction& run_trial,
                const std::function<bool()>& stop_requested) {
  for (const PlannedTrial& trial : trials) {
    if (stop_requested()) return false;
    const auto before = std::find_if(stored.begin(), stored.end(),
                                     [&](const StoredTrial& s) { return s.plan.id == trial.id; });
    const fs::path video = VideoOf(directory, trial.id);
    fs::create_directories(video.parent_path());
    const ScratchFolder folder(directory);
    TrialOutput output;
    output.folder = folder.path();
    output.video = output.annotate = true;
    const TrialResult now = RunAgain(trial, run_trial, output);
    ThrowUnless(before != stored.end() && Differences(*before->result, now).empty(),
                "{}: trial {} differs from what was recorded; replay tells how", directory,
                trial.id);
    // A trial that ends before it moves has no film.
    const fs::path filmed = fs::path(folder.path()) / "grasp.mp4";
    if (fs::exists(filmed)) fs::rename(filmed, video);
  }
  return true;
}

}  // namespace springgrasp
