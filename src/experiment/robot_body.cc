#include "experiment/robot_body.h"

#include <algorithm>

#include "kinematics/mirror.h"
#include "sim/arm_body_of.h"
#include "sim/kinematic_tree_of.h"
#include "sim/scene_builder.h"

namespace springgrasp {

std::string GraspingSide(const Scene& scene) {
  const auto active = [&](const char* part) {
    return std::find(scene.active.begin(), scene.active.end(), part) != scene.active.end();
  };
  return active("left_hand") && !active("right_hand") ? "l" : "r";
}

RobotBody MakeRobotBody(const Simulation& simulation, const std::string& side) {
  const mjModel& model = simulation.model();
  const std::string hand = "hand_" + side, frame = hand + "_H";
  const KinematicTree world = KinematicTreeOf(model, "world", {frame});
  const ModelPtr human = LoadModelFile(ModelPath("mmm_hand/mmm_hand_r.xml"));
  const Arm arm =
      MakeArm(world, frame, "arm_" + side + "_", JointPositions(world, model, simulation.data()));
  const ArmBody body = ArmBodyOf(arm, model, simulation.data());
  const KinematicTree fingers = KinematicTreeOf(model, hand);
  const HumanHand human_hand = MakeHumanHand(KinematicTreeOf(*human, "mmm_hand"));
  if (side == "r") return {arm, body, MakeArmarHand(fingers, "hand_r"), human_hand, false};
  return {MirroredArm(arm), MirroredArmBody(body),
          MakeArmarHand(MirroredTree(fingers, false), "hand_r"), human_hand, true};
}

}  // namespace springgrasp
