#include "vision/hand_model.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace springgrasp {
namespace {

constexpr double kFingerRadius = 0.0088;  // m, of an adult's fingers
constexpr double kTipRadius = 0.0095;     // m, with its cap
constexpr double kPalmRadius = 0.012;     // m, half the thickness of a palm
constexpr double kBallSpacing = 0.014;    // m

void AddBone(HandModel& model, int node, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
             double radius) {
  const int count = std::max(1, static_cast<int>(std::lround((to - from).norm() / kBallSpacing)));
  for (int i = 0; i < count; ++i) {
    model.balls.push_back({node, from + (to - from) * (i + 0.5) / count, radius});
  }
}

bool Contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

HandModel MakeHandModel(const KinematicTree& tree, const Eigen::VectorXd& rest) {
  HandModel model;
  model.tree = tree;
  const int n = tree.num_joints();
  PerFinger<int> knuckle = {};  // node where the finger leaves the palm
  for (int f = 0; f < kNumFingers; ++f) {
    model.tip[f] = tree.FrameIndex("mmm_" + std::string(kFingerNames[f]) + "_tip");
    // Bones from the tip inwards, up to the palm. The tip's own ball is a cap's.
    int node = tree.frames[model.tip[f]].node;
    Eigen::Vector3d end = tree.frames[model.tip[f]].X_BF.translation();
    model.balls.push_back({node, end, kTipRadius});
    while (node >= 0) {
      const int parent = tree.nodes[node].parent;
      if (end.norm() > 0.005) AddBone(model, node, Eigen::Vector3d::Zero(), end, kFingerRadius);
      end = tree.nodes[node].X_PB.translation();
      if (parent >= 0 && end.norm() > 0.005) {
        // A joint of the palm (CMC) or the root itself: the finger begins here.
        const bool palm = tree.nodes[parent].parent < 0 ||
                          (tree.nodes[parent].joint >= 0 &&
                           Contains(tree.joint_names[tree.nodes[parent].joint], "pinkie_cmc"));
        if (palm) {
          knuckle[f] = node;
          break;
        }
      }
      node = parent;
    }
    ThrowUnless(node >= 0, "hand model: finger '{}' does not hang on a palm", kFingerNames[f]);
  }
  // Palm: rows from the wrist to the knuckles at joint angles zero, fixed to the root.
  std::vector<Pose> X_HB;
  ForwardKinematics(tree, Eigen::VectorXd::Zero(n), X_HB);
  const auto row_start = [&](const Eigen::Vector3d& p_HK) {
    return Eigen::Vector3d(0.012, 0.6 * p_HK.y(), 0);
  };
  for (int f = kIndex; f < kNumFingers; ++f) {
    const Eigen::Vector3d p_HK = X_HB[knuckle[f]].translation();
    AddBone(model, 0, row_start(p_HK), p_HK, kPalmRadius);
    if (f == kIndex) continue;
    const Eigen::Vector3d between = (p_HK + X_HB[knuckle[f - 1]].translation()) / 2;
    AddBone(model, 0, row_start(between), between, kPalmRadius);
  }
  // Balls of thumb and pinkie, heel of the hand: y of H points to the thumb on a right hand.
  const Eigen::Vector3d p_HT = X_HB[knuckle[kThumb]].translation();
  const double side = p_HT.y() >= 0 ? 1 : -1;
  AddBone(model, 0, p_HT, 0.6 * X_HB[knuckle[kIndex]].translation(), kPalmRadius);
  model.balls.push_back({0, {0.034, 0.016 * side, -0.004}, 0.0165});
  model.balls.push_back({0, {0.038, -0.021 * side, -0.004}, 0.0165});
  model.balls.push_back({0, {0.004, 0.009, 0}, 0.0175});
  model.balls.push_back({0, {0.004, -0.009, 0}, 0.0175});
  // Forearm: explains skin beyond the wrist. x of H points to the middle knuckle.
  for (int i = 1; i <= 5; ++i) model.balls.push_back({0, {-0.02 * i, 0, 0}, 0.027, true});

  model.finger.assign(static_cast<std::size_t>(n), kThumb);
  model.abduction.assign(static_cast<std::size_t>(n), false);
  model.bends = model.abduction;
  for (int f = 0; f < kNumFingers; ++f) {
    for (int b = tree.frames[model.tip[f]].node; b >= 0; b = tree.nodes[b].parent) {
      if (tree.nodes[b].joint >= 0) model.finger[tree.nodes[b].joint] = f;
    }
  }
  model.rest.resize(n);
  model.rest_sigma.resize(n);
  for (int j = 0; j < n; ++j) {
    const std::string& name = tree.joint_names[j];
    const bool abduction = Contains(name, "abduction");
    model.abduction[j] = abduction;
    model.bends[j] = !abduction && !Contains(name, "cmc");
    model.rest[j] = abduction ? 0
                              : tree.lower[j] + (tree.upper[j] - tree.lower[j]) *
                                                    (Contains(name, "cmc") ? 0.5 : 0.2);
    model.rest_sigma[j] = abduction ? 0.12 : 1.0;
  }
  if (rest.size() == n) model.rest = rest;
  for (int j = 0; j < n; ++j) {
    const std::string& name = tree.joint_names[j];
    if (!Contains(name, "_dip")) continue;
    std::string middle = name;
    middle.replace(middle.find("_dip"), 4, "_pip");
    model.coupled.emplace_back(tree.JointIndex(middle), j);
  }
  for (int f = kIndex; f + 1 < kNumFingers; ++f) {
    for (const char* joint : {"_mcp", "_pip"}) {
      model.neighbours.emplace_back(
          tree.JointIndex("mmm_" + std::string(kFingerNames[f]) + joint),
          tree.JointIndex("mmm_" + std::string(kFingerNames[f + 1]) + joint));
    }
  }
  return model;
}

void KeepBareForearm(const std::vector<bool>& bare, HandModel& model) {
  std::vector<HandBall> kept;
  bool sleeve = false;
  for (std::size_t i = 0; i < model.balls.size(); ++i) {
    const HandBall& ball = model.balls[i];
    if (!ball.forearm) {
      kept.push_back(ball);
      continue;
    }
    if (!sleeve && !bare.at(i)) {
      sleeve = true;
      if (!kept.empty() && kept.back().forearm) kept.back().cut = true;
    }
    if (!sleeve) kept.push_back(ball);
  }
  model.balls = kept;
}

}  // namespace springgrasp
