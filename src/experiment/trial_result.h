// OUTCOME: one trial's record, with the errors of every stage.
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

namespace springgrasp {

// Exactly one per trial (system contract, section 6).
enum class Outcome {
  kSuccess,
  kUnreachable,
  kCollided,
  kMissed,
  kDroppedLift,
  kDroppedHold,
  kDroppedDisturb,
  kDroppedPlace,
  kWrongContacts,
  kSlipped,
  kUntracked,
  kDiverged,
  kError
};

inline constexpr std::array<std::string_view, 13> kOutcomeNames = {
    "success",      "unreachable",     "collided",      "missed",         "dropped_lift",
    "dropped_hold", "dropped_disturb", "dropped_place", "wrong_contacts", "slipped",
    "untracked",    "diverged",        "error"};

constexpr std::string_view OutcomeName(Outcome outcome) {
  return kOutcomeNames[static_cast<std::size_t>(outcome)];
}

struct TrialResult {
  Outcome outcome = Outcome::kError;
  std::string message;  // why, in one line; empty for success
  std::string phase;    // that the trial reached
  // Named measurements; what was not measured is absent. Units in the names, SI otherwise:
  // tracking_median_mm, tracking_95_mm, coverage, wrist_error_mm, wrist_error_deg,
  // reproduction_<finger>_mm, condition_number, k_<i><j>, k_se_<i><j>, mapping_error_mm,
  // arm_error_mm, finger_error_mm, normal_<finger>_n, palm_normal_n, slip_mm, rotation_deg,
  // creep_mm_s, epsilon, volume, opposition_deg, grip_epsilon, shake_fraction, object_x, object_y, ...
  std::map<std::string, double> values;
  std::map<std::string, double> wall_s;  // seconds per stage; kept in a table of their own
  // Files of the trial could not be written (message: which): no outcome, to be run again.
  bool not_written = false;
};

}  // namespace springgrasp
