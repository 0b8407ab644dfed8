// The shipped hands and arm as kinematic trees.
#pragma once

#include <mujoco/mujoco.h>

#include <Eigen/Core>
#include <memory>
#include <stdexcept>
#include <string>

#include "base/files.h"
#include "base/random.h"
#include "kinematics/hand_ik.h"
#include "kinematics/human_hand.h"
#include "kinematics/robot_hand.h"
#include "sim/kinematic_tree_of.h"

namespace springgrasp {

inline std::shared_ptr<mjModel> LoadModel(const std::string& path) {
  char error[500] = "";
  mjModel* model = mj_loadXML((SourceFolder() + "/models/" + path).c_str(), nullptr, error, 500);
  if (model == nullptr) throw std::runtime_error(error);
  return {model, mj_deleteModel};
}

// Fingertips of a posture, in H.
inline KnownTips TipsAt(const HumanHand& hand, const Eigen::VectorXd& q) {
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, q, X_HB);
  KnownTips tips;
  for (int f = 0; f < kNumFingers; ++f) {
    tips[f] = FramePose(hand.tree, X_HB, hand.tip[f]).translation();
  }
  return tips;
}

inline const HumanHand& TestHumanHand() {
  static const HumanHand hand = [] {
    const auto model = LoadModel("mmm_hand/mmm_hand_r.xml");
    return MakeHumanHand(KinematicTreeOf(*model, "mmm_hand"));
  }();
  return hand;
}

inline const RobotHand& TestRobotHand() {
  static const RobotHand hand = [] {
    const auto model = LoadModel("armar3b/armar3b.xml");
    return MakeArmarHand(KinematicTreeOf(*model, "hand_r"), "hand_r");
  }();
  return hand;
}

inline const RobotHand& TestOppositionHand() {
  static const RobotHand hand = [] {
    const auto model = LoadModel("armar3b/armar3b_opposition.xml");
    return MakeArmarHand(KinematicTreeOf(*model, "hand_r"), "hand_r");
  }();
  return hand;
}

inline Eigen::VectorXd RandomPosture(const KinematicTree& tree, RandomEngine& engine) {
  Eigen::VectorXd q(tree.num_joints());
  for (int j = 0; j < q.size(); ++j) q[j] = Uniform(engine, tree.lower[j], tree.upper[j]);
  return q;
}

}  // namespace springgrasp
