// Scene -> MJCF text -> mjModel. Pure: same scene, same model.
#pragma once

#include <optional>
#include <string>

#include "sim/mujoco_handles.h"
#include "sim/scene.h"

namespace springgrasp {

struct BuildOptions {
  bool with_robot = true;
  bool with_table = true;
  bool with_objects = true;  // free bodies `<name>` with joint `<name>_free`
  // Adds the human hand, sized and coloured by scene.demonstrator (demonstrator_part.h): body
  // mmm_hand becomes a mocap body (PlaceBody moves it), its finger joints are set kinematically,
  // nothing of it collides. So do the plates and the clutter of display_furniture.h.
  bool with_demonstrator = false;
  std::string demonstrator_model = "mmm_hand/mmm_hand_r.xml";
  // The demonstrator's object as a visual mocap body "shown_object" (its shape below).
  std::optional<Shape> shown_object;
  // The robot's looks; without them physics is the same and steps are faster.
  bool with_looks = true;
  int offscreen_samples = 0;  // multisampling, compiled into the model; 4 for videos
};

// Bodies `floor`(geom), `table`, `<object>`, `<object>_ring`; cameras of the scene and the robot;
// all robot names as in its own file. Joints of subsystems that are not active are removed and
// their start angle kept (actuators, sensors, tendons, equalities on them go too).
std::string BuildMjcf(const Scene& scene, const BuildOptions& options = {});

// Compiles it; the keyframe "start" holds the start posture and the objects' start poses.
ModelPtr BuildModel(const Scene& scene, const BuildOptions& options = {});

// Joint name -> subsystem: torso, head, right_arm, right_hand, left_arm, left_hand, or "" .
std::string SubsystemOfJoint(const std::string& joint);

// Full path of a model file: absolute as it is, else below models/ of the source folder.
std::string ModelPath(const std::string& path);

}  // namespace springgrasp
