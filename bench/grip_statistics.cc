// The shipped grasps gripped in physics: what is lost before the disturbances, the fingers' forces
// against those asked for, the arm's errors.
//   grip_statistics [DRAWS] [SEED] [FRICTION] [MASS]   (50, 1001, 1.25, 1)
// FRICTION and MASS: believed over true friction, true mass over the scene's.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <string>

#include "experiment/perform_grasp.h"
#include "experiment/trial_result.h"
#include "grasp/grasp.h"
#include "sim/scene_builder.h"
#include "statistics_main.h"

namespace springgrasp {
namespace {
int Main(int argc, char** argv) {
  const int draws = argc > 1 ? std::atoi(argv[1]) : 50;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1001;
  const double friction = argc > 3 ? std::atof(argv[3]) : 1.25;
  const double mass = argc > 4 ? std::atof(argv[4]) : 1;
  const std::pair<const char*, const char*> cases[] = {
      {"pinch", "pinch_ball"}, {"tripod", "tripod_cylinder"}, {"power", "power_cylinder"}};
  for (const auto& [type, file] : cases) {
    if (argc > 5 && std::string(argv[5]) != type) continue;
    const Grasp grasp = ReadGrasp(ModelPath(fmt::format("grasps/{}.yaml", type)));
    std::map<std::string, int> outcomes;
    for (int n = 0; n < draws; ++n) {
      Scene scene = ReadScene(fmt::format("scenes/{}.yaml", file));
      scene.objects[0].mass *= mass;
      scene.objects[0].believed.friction = friction - 1;
      RandomEngine pose = MakeStream(seed, static_cast<std::uint64_t>(n), "pose");
      DrawObjectPoses(scene, pose);
      PerformGraspOptions options;
      options.actuation = MakeStream(seed, static_cast<std::uint64_t>(n), "actuation");
      const TrialResult r = PerformGrasp(grasp, scene, options);
      ++outcomes[std::string(OutcomeName(r.outcome))];
      fmt::print("{} {:2d} {:<15} {}", type, n, OutcomeName(r.outcome), r.message);
      for (const auto& [key, value] : r.values) {
        if (key.starts_with("arm_") || key == "regrips" || key.starts_with("grip_") ||
            key.starts_with("slip_") || key.starts_with("rotation_") ||
            (key.ends_with("_n") && (key.starts_with("force") || key.starts_with("largest"))) ||
            key.starts_with("finger_") || key.starts_with("be"))
          fmt::print(" {}={:.2f}", key, value);
      }
      fmt::print("\n");
      std::fflush(stdout);
    }
    for (const auto& [outcome, count] : outcomes) fmt::print("{}: {} {}\n", type, outcome, count);
  }
  return 0;
}
}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return StatisticsMain(argc, argv, springgrasp::Main); }
