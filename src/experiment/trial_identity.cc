#include "experiment/trial_identity.h"

#include <fmt/format.h>

#include "base/random.h"
#include "experiment/experiment_criteria.h"

namespace springgrasp {

std::string CanonicalText(const TrialSpec& spec) {
  std::string text = fmt::format(
      "grasp: {}\ndim: {}\nprofile: {}\nsubstitute: {}\nbaseline: {}\nseed: {}\nrepetition: {}\n",
      spec.grasp_type, spec.dim, spec.profile, fmt::join(spec.substitute, ","), spec.baseline,
      spec.seed, spec.repetition);
  // Written only where it is not the default, so that older trials keep their identity.
  if (!spec.grasp_hash.empty()) text += fmt::format("library: {}\n", spec.grasp_hash);
  if (spec.object_centre) text += "contacts: centre\n";
  if (spec.until != "perform") text += fmt::format("until: {}\n", spec.until);
  for (const CriterionField& field : kCriterionFields) {
    text += fmt::format("criteria.{}: {}\n", field.name, spec.criteria.*field.member);
  }
  return text + spec.scene_text;
}

std::string TrialIdentity(const TrialSpec& spec) {
  return fmt::format("{:016x}", HashText(CanonicalText(spec)));
}

}  // namespace springgrasp
