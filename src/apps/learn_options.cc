#include "apps/learn_options.h"

namespace springgrasp {

void AddLearnOptions(CLI::App& command, LearnOptions& options) {
  command.add_option("--type", options.type, "grasp type")
      ->required()
      ->check(CLI::IsMember({"pinch", "tripod", "power", "lateral"}));
  command
      .add_option("--dim", options.dim, "springs in the hand plane (2, the paper) or in space (3)")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  command
      .add_option("--profile", options.profile,
                  "human, paper: without our extensions, unforced: without central force")
      ->check(CLI::IsMember({"human", "paper", "unforced"}))
      ->capture_default_str();
  command
      .add_option("--hand-length", options.hand_length,
                  "of the demonstrator, wrist to middle fingertip, m: scales the rest lengths")
      ->check(CLI::Range(0.1, 0.3))
      ->capture_default_str();
}

}  // namespace springgrasp
