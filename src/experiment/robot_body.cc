#include "experiment/robot_body.h"

#include "sim/arm_body_of.h"
#include "sim/kinematic_tree_of.h"
#include "sim/scene_builder.h"

namespace springgrasp {

RobotBody MakeRobotBody(const Simulation& simulation) {
  const mjModel& model = simulation.model();
  const KinematicTree world = KinematicTreeOf(model, "world", {"hand_r_H"});
  const ModelPtr human = LoadModelFile(ModelPath("mmm_hand/mmm_hand_r.xml"));
  const Arm arm =
      MakeArm(world, "hand_r_H", "arm_r_", JointPositions(world, model, simulation.data()));
  return {arm, ArmBodyOf(arm, model, simulation.data()),
          MakeArmarHand(KinematicTreeOf(model, "hand_r"), "hand_r"),
          MakeHumanHand(KinematicTreeOf(*human, "mmm_hand"))};
}

}  // namespace springgrasp
