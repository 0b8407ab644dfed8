#include "experiment/demonstrator_hand.h"

#include <algorithm>
#include <string>

#include "base/files.h"
#include "base/yaml_reader.h"

namespace springgrasp {

Eigen::VectorXd PostureOf(const KinematicTree& tree, const ThumbAngles& thumb,
                          const std::array<FingerAngles, 4>& fingers) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.num_joints());
  q[tree.JointIndex("mmm_thumb_cmc_opposition")] = thumb.opposition;
  q[tree.JointIndex("mmm_thumb_cmc_flexion")] = thumb.flexion;
  q[tree.JointIndex("mmm_thumb_mcp")] = thumb.mcp;
  q[tree.JointIndex("mmm_thumb_ip")] = thumb.ip;
  for (int i = 0; i < 4; ++i) {
    const std::string name = "mmm_" + std::string(kFingerNames[i + 1]);
    q[tree.JointIndex(name + "_abduction")] = fingers[i].abduction;
    q[tree.JointIndex(name + "_mcp")] = fingers[i].mcp;
    q[tree.JointIndex(name + "_pip")] = fingers[i].pip;
    q[tree.JointIndex(name + "_dip")] = fingers[i].dip;
  }
  return q.cwiseMax(tree.lower).cwiseMin(tree.upper);
}

Eigen::VectorXd ReadPosture(const KinematicTree& tree, const std::string& path) {
  YamlReader yaml = YamlReader::FromFile(path);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.num_joints());
  for (int j = 0; j < tree.num_joints(); ++j) {
    yaml.Read(tree.joint_names[j], q[j], {tree.lower[j], tree.upper[j]});
  }
  yaml.Finish();
  return q;
}

DemonstratorHand MakeDemonstratorHand(KinematicTree tree, const HandSize& size,
                                      const std::string& folder) {
  DemonstratorHand hand;
  hand.tree = std::move(tree);
  hand.size = size;
  hand.tip_radius *= hand.scale();
  hand.finger_radius *= hand.scale();
  for (int f = 0; f < kNumFingers; ++f) {
    hand.tip_frames[f] = hand.tree.FrameIndex("mmm_" + std::string(kFingerNames[f]) + "_tip");
    // Bodies at the same place (abduction and flexion) count once.
    for (int b = hand.tree.frames[hand.tip_frames[f]].node; b > 0; b = hand.tree.nodes[b].parent) {
      hand.links[f].push_back(b);
      while (b > 0 && hand.tree.nodes[b].X_PB.translation().norm() < 1e-6) {
        b = hand.tree.nodes[b].parent;
      }
    }
    std::reverse(hand.links[f].begin(), hand.links[f].end());
    // Pinkie: its carpal body lies in the palm, a finger begins at the knuckle.
    while (hand.links[f].size() > 3) hand.links[f].erase(hand.links[f].begin());
  }
  const std::string from = folder.empty() ? SourceFolder() + "/models/mmm_hand" : folder;
  hand.open = ReadPosture(hand.tree, from + "/open.yaml");
  hand.relaxed = ReadPosture(hand.tree, from + "/relaxed.yaml");
  return hand;
}

void ComputeHandShape(const DemonstratorHand& hand, const Eigen::Ref<const Eigen::VectorXd>& q,
                      std::vector<Pose>& bodies, HandShape& shape) {
  ForwardKinematics(hand.tree, q, bodies);
  for (int f = 0; f < kNumFingers; ++f) {
    shape.tips[f] = FramePose(hand.tree, bodies, hand.tip_frames[f]).translation();
    shape.chains[f].clear();
    for (const int b : hand.links[f]) shape.chains[f].push_back(bodies[b].translation());
    shape.chains[f].push_back(shape.tips[f]);
  }
}

HandShape ComputeHandShape(const DemonstratorHand& hand, const Eigen::VectorXd& q) {
  std::vector<Pose> bodies;
  HandShape shape;
  ComputeHandShape(hand, q, bodies, shape);
  return shape;
}

}  // namespace springgrasp
