// One trial, fully determined: what an experiment expands to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "experiment/phases.h"
#include "sim/scene.h"

namespace springgrasp {

struct TrialSpec {
  // Where it belongs; not part of the identity.
  std::string case_name;      // with its variation: "power" or "power objects.0.mass=0.2"
  std::string demonstration;  // name of the recorded file without extension; "synthesised"
  std::vector<std::pair<std::string, double>> drawn;  // sampled keys of the scene, as drawn

  // Effective parameters: all of these are part of the identity.
  Scene scene;                    // overrides applied, poses not yet drawn; with its demonstrator
  std::string scene_text;         // canonical text of the above (files by their content)
  std::string grasp_type;         // pinch | tripod | power | lateral
  std::string until = "perform";  // perform | observe: where the trial ends
  int dim = 3;                    // of the springs
  std::string profile = "human";  // human | paper
  bool object_centre = false;     // Eq. (6) alone: fingers know the object's centre, no contacts
  TrialCriteria criteria;
  std::vector<std::string> substitute;  // stages replaced by truth, sorted
  bool open_hand = false;  // baseline: the demonstration is replaced by a constant open hand
  std::uint64_t seed = 0;  // of the experiment; streams: MakeStream(seed, repetition, name)
  int repetition = 0;
};

// What a trial may write. `folder` exists already; nothing is written outside it.
struct TrialOutput {
  std::string folder;         // empty: write nothing
  bool trajectories = false;  // demonstration, grasp, motion and what the robot did
  bool video = false;         // robot and object
  bool annotate = false;      // contact forces and fingertips drawn into it
  bool overlay = false;       // the tracker's view
};

// Stages that truth can take the place of (system contract, section 1; the others are not built).
inline const std::vector<std::string> kSubstitutes = {"tracks", "hand_pose", "object_pose"};

}  // namespace springgrasp
