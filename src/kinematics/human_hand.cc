#include "kinematics/human_hand.h"

#include <string>
#include <utility>

#include "base/error.h"

namespace springgrasp {
namespace {

constexpr double kRestThumb[4] = {0.9, 0.0, 0.25, 0.25};
constexpr double kRestFinger[4] = {0.0, 0.35, 0.45, 0.25};

}  // namespace

HumanHand MakeHumanHand(KinematicTree tree) {
  HumanHand hand;
  hand.tree = std::move(tree);
  hand.rest = Eigen::VectorXd::Zero(hand.tree.num_joints());
  for (int f = 0; f < kNumFingers; ++f) {
    const std::string finger = "mmm_" + std::string(kFingerNames[f]);
    std::vector<std::string> names;
    if (f == kThumb) {
      names = {finger + "_cmc_opposition", finger + "_cmc_flexion", finger + "_mcp",
               finger + "_ip"};
    } else {
      if (f == kPinkie) names.push_back(finger + "_cmc");
      for (const char* part : {"_abduction", "_mcp", "_pip", "_dip"}) {
        names.push_back(finger + part);
      }
    }
    const std::size_t first = names.size() - 4;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const int joint = hand.tree.JointIndex(names[i]);
      hand.joints[f].push_back(joint);
      if (i >= first) hand.rest[joint] = (f == kThumb ? kRestThumb : kRestFinger)[i - first];
    }
    hand.tip[f] = hand.tree.FrameIndex(finger + "_tip");
    for (std::size_t n = 0; n < hand.tree.nodes.size(); ++n) {
      if (hand.tree.nodes[n].joint == hand.joints[f][first]) hand.base[f] = static_cast<int>(n);
    }
  }
  hand.rest = hand.rest.cwiseMax(hand.tree.lower).cwiseMin(hand.tree.upper);
  std::vector<Pose> X_HB;
  ForwardKinematics(hand.tree, Eigen::VectorXd::Zero(hand.tree.num_joints()), X_HB);
  for (int f = 0; f < kNumFingers; ++f) {
    hand.length[f] =
        (FramePose(hand.tree, X_HB, hand.tip[f]).translation() - X_HB[hand.base[f]].translation())
            .norm();
  }
  return hand;
}

HumanHand ScaledHand(const HumanHand& hand, double factor) {
  HumanHand scaled = hand;
  for (KinematicTree::Node& node : scaled.tree.nodes) node.X_PB.translation() *= factor;
  for (KinematicTree::Frame& frame : scaled.tree.frames) frame.X_BF.translation() *= factor;
  for (double& length : scaled.length) length *= factor;
  return scaled;
}

PerFinger<FlexionAngles> FlexionOf(const HumanHand& hand, const Eigen::VectorXd& q) {
  PerFinger<FlexionAngles> flexion;
  for (int f = 0; f < kNumFingers; ++f) {
    const std::vector<int>& j = hand.joints[f];
    const std::size_t n = j.size();
    if (f == kThumb) {
      flexion[f] = {q[j[1]] + q[j[2]], q[j[3]]};
    } else {
      flexion[f] = {q[j[n - 3]], q[j[n - 2]] + q[j[n - 1]]};
    }
  }
  return flexion;
}

double OppositionOf(const HumanHand& hand, const Eigen::VectorXd& q) {
  return q[hand.joints[kThumb].front()];
}

}  // namespace springgrasp
