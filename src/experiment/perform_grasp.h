// One grasp of the library on a scene: plan it, perform it, judge it.
#pragma once

#include <optional>
#include <string>

#include "experiment/perform.h"
#include "experiment/plan_grasp.h"
#include "experiment/plan_memory.h"
#include "experiment/trial_result.h"
#include "experiment/trial_spec.h"
#include "grasp/grasp.h"
#include "sim/scene.h"

namespace springgrasp {

struct PerformGraspOptions {
  TrialCriteria criteria;
  RandomEngine actuation{0};   // stream "actuation" of the trial
  bool believe_truth = false;  // the object's true pose, size, mass and friction are known
  // In the place of the drives: the arm's joints are where they are wanted at every step; the
  // fingers' too, until the hand arrives (T).
  bool exact_arm = false, exact_fingers = false;
  bool object_centre = false;  // Eq. (6) alone, no contact points
  // What moves the fingers in the springs' place (its synergies are found here); none: the springs.
  std::optional<BaselineRequest> baseline;
  std::string camera;      // of the video; empty: the scene's overview cameras side by side
  std::string video;       // .mp4, if not empty
  bool annotate = false;   // contact forces and fingertips drawn into the video
  std::string trajectory;  // .csv of what the robot did, if not empty
  std::string motion;      // .csv of the generated fingertip motion, if not empty
  std::string plan_key;    // of all that is planned from; empty: no plan is kept
};

// `scene`: poses drawn already; the first object is grasped. Where it is out of reach and the scene
// lets torso or platform move (`torso: free`; `platform` active), the robot stands as
// MovesIntoReach says from the start, recorded as start_<joint>. Fills outcome, message, phase and
// the values of planning and physics of the result, from a plan of `plans` where
// it has that; never throws for what physics does.
TrialResult PerformGrasp(const Grasp& grasp, const Scene& scene, const PerformGraspOptions& options,
                         PlanMemory& plans);
// Likewise, keeping no plan.
TrialResult PerformGrasp(const Grasp& grasp, const Scene& scene,
                         const PerformGraspOptions& options);

}  // namespace springgrasp
