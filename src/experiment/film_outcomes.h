// Videos of the trials that tell most, once a run knows its outcomes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "experiment/runner.h"
#include "experiment/store.h"

namespace springgrasp {

// Of each condition the first success and the first failure, in the order of the plan; those that
// have a video in `directory` already, and what cannot be filmed (until: observe), are left out.
std::vector<PlannedTrial> TrialsToFilm(const std::vector<PlannedTrial>& planned,
                                       const std::vector<StoredTrial>& stored,
                                       const std::string& directory);

// Runs them again, filmed, into <directory>/trials/<id>/grasp.mp4, until `stop_requested` says
// true; false then. Throws Error if one has another outcome than before.
bool FilmTrials(const std::vector<PlannedTrial>& trials, const std::vector<StoredTrial>& stored,
                const std::string& directory, const TrialFunction& run_trial,
                const std::function<bool()>& stop_requested);

}  // namespace springgrasp
