#include <algorithm>
#include <numbers>

#include "kinematics/hand_mapping.h"

namespace springgrasp {

MappingTarget TargetFromHuman(const HumanHand& human, const Eigen::VectorXd& q_human,
                              const RobotHand& robot) {
  MappingTarget target;
  target.lambda.fill(1);
  if (robot.opposition >= 0) {
    target.opposition =
        std::clamp(std::numbers::pi / 2 - OppositionOf(human, q_human),
                   robot.tree.lower[robot.opposition], robot.tree.upper[robot.opposition]);
  }
  const PerFinger<FlexionAngles> flexion = FlexionOf(human, q_human);
  std::vector<Pose> X_human, X_robot;
  ForwardKinematics(human.tree, q_human, X_human);
  ForwardKinematics(robot.tree, robot.open, X_robot);
  for (int f = 0; f < kNumFingers; ++f) {
    const RobotHand::Finger& finger = robot.fingers[f];
    const Eigen::Vector2d wanted =
        Eigen::Vector2d(flexion[f].proximal, flexion[f].distal) + finger.flexion_offset;
    target.sigma[f][0] =
        std::clamp(wanted[0], robot.tree.lower[finger.j0], robot.tree.upper[finger.j0]);
    target.sigma[f][1] =
        std::clamp(wanted[1], robot.tree.lower[finger.j1], robot.tree.upper[finger.j1]);
    const Eigen::Vector3d reach = FramePose(human.tree, X_human, human.tip[f]).translation() -
                                  X_human[human.base[f]].translation();
    target.p_HF[f] =
        X_robot[finger.base].translation() + finger.length / human.length[f] * (robot.R_HA * reach);
  }
  return target;
}

}  // namespace springgrasp
