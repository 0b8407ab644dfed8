// The verdict of a trial (system contract, section 6): a function of what was recorded.
#pragma once

#include <string>
#include <vector>

#include "base/shape.h"
#include "experiment/contact_window.h"
#include "experiment/phases.h"
#include "experiment/trial_result.h"

namespace springgrasp {

// Whether a window's contacts are those that a grasp type asks for.
struct ContactCheck {
  bool ok = false;
  std::string reason;         // first condition that fails, empty if ok
  double opposition_deg = 0;  // angle between the thumb's force and the other fingers'
  double epsilon = 0;         // of the counted contacts alone
  double volume = 0;
  double task = 0;  // against weight and disturbing forces, as GraspQuality6d::task
};
ContactCheck CheckContacts(const std::string& type, const ContactWindow& window, const Shape& shape,
                           const TrialCriteria& criteria);

// True if the window holds an opposed contact of thumb and other fingers (or palm).
bool IsOpposed(const ContactWindow& window, const TrialCriteria& criteria);

// What went wrong, and when; the earliest decides.
struct TrialEvent {
  double t = 0;  // s
  Outcome outcome = Outcome::kSuccess;
  std::string message;
};
// The earliest event (ties: the order given); success if there is none. `error` and `diverged`
// come before all.
TrialEvent DecideOutcome(const std::vector<TrialEvent>& events);

}  // namespace springgrasp
