#include "experiment/observation_key.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/yaml_reader.h"
#include "experiment/trial_identity.h"

namespace springgrasp {

std::string ObservationKey(const TrialSpec& spec) {
  std::string scene = spec.scene_text;
  for (const char* key : {"physics", "pneumatics", "max_finger_force", "cameras"}) {
    scene = RemoveKey(scene, key);
  }
  for (std::size_t i = 0; i < spec.scene.objects.size(); ++i) {
    for (const char* key : {"mass", "friction", "believed"}) {
      scene = RemoveKey(scene, fmt::format("objects.{}.{}", i, key));
    }
  }
  return fmt::format("seed: {}\nrepetition: {}\n{}", spec.seed, spec.repetition, scene);
}

std::string LearningKey(const TrialSpec& spec) {
  return fmt::format("{} {} {} {} {}\n{}", spec.grasp_type, spec.dim, spec.profile,
                     spec.baseline == "open_hand", fmt::join(spec.substitute, ","),
                     ObservationKey(spec));
}

std::string PlanKey(const TrialSpec& spec) {
  TrialSpec planned = spec;
  for (const char* key : {"physics", "pneumatics"}) {
    planned.scene_text = RemoveKey(planned.scene_text, key);
  }
  return CanonicalText(planned);
}

}  // namespace springgrasp
