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
  std::string case_name;  // with its variation: "power" or "power objects.0.mass=0.2"
  std::string
      demonstration;  // name of the recorded file without extension; "synthesised", "library"
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
  // Entry of the library that is performed, its demonstration (.csv) beside it; empty: the trial
  // sees a demonstration and learns from it.
  std::string grasp_file;
  std::string blend_file;         // the grasp is that at blend_part of the way to this; or empty
  double blend_part = 0;          // 0..1
  std::string grasp_hash;         // of all these files, with the part
  std::string baseline = "none";  // one of kBaselines: what moves the fingers in the springs' place
  std::uint64_t seed = 0;         // of the experiment; streams: MakeStream(seed, repetition, name)
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

// Stages that truth can take the place of (system contract, section 1):
//   tracks, hand_pose  fingertips and hand as they were shown
//   contacts, k        contacts and their frames; spring constants and what drives them: those of a
//                      grasp learned from the true tracks and hand poses
//   finger_joints      exactly as planned until the hand arrives (T), without drives
//   arm                exactly as planned throughout
//   object_pose        the object as it is, not as believed
inline const std::vector<std::string> kSubstitutes = {
    "tracks", "hand_pose", "contacts", "k", "finger_joints", "arm", "object_pose"};

// What a trial is compared with; same reach, believed object, force controller and verdict.
//   open_hand      the demonstration is replaced by a constant open hand
//   interpolation  straight from the open hand to the demonstrated joint angles (synergy closure)
//   playback       the demonstrated fingertips as they were, without springs or contacts
//   synergies      the first two principal components of the library's joint angles
inline const std::vector<std::string> kBaselines = {"open_hand", "interpolation", "playback",
                                                    "synergies"};

}  // namespace springgrasp
