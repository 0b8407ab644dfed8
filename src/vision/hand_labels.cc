#include "vision/hand_labels.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

using Points = Eigen::Matrix<double, 3, kNumFingers>;

// Tips in H, of fingers that bend alike.
std::vector<Points> TipsOfPostures(const HandModel& model) {
  std::vector<Points> postures;
  std::vector<Pose> X_HB;
  for (const double bend : {0.2, 1.0, 1.8, 2.6}) {
    const Eigen::VectorXd q =
        (bend * model.rest).cwiseMax(model.tree.lower).cwiseMin(model.tree.upper);
    ForwardKinematics(model.tree, q, X_HB);
    Points& tips = postures.emplace_back();
    for (int f = 0; f < kNumFingers; ++f) {
      const KinematicTree::Frame& frame = model.tree.frames[model.tip[f]];
      tips.col(f) = X_HB[frame.node] * frame.X_BF.translation();
    }
  }
  return postures;
}

}  // namespace

std::vector<HandLabels> RankLabels(const HandModel& model, const StereoCameras& cameras,
                                   const PerFinger<Eigen::Vector3d>& caps_W) {
  constexpr double kMostScale = 1.2, kLeastFacing = -0.2;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const auto& cap : caps_W) middle += cap / kNumFingers;
  const Eigen::Vector3d sight = (middle - cameras.left.X_WC.translation()).normalized();
  std::vector<HandLabels> ranked;
  const std::vector<Points> postures = TipsOfPostures(model);
  PerFinger<int> order = {0, 1, 2, 3, 4};
  do {
    Points caps;
    for (int f = 0; f < kNumFingers; ++f) caps.col(f) = caps_W[order[f]] - middle;
    double best = 1e9;
    for (const Points& posture : postures) {
      const Points tips = posture.colwise() - posture.rowwise().mean();
      const Eigen::Matrix3d R = Eigen::umeyama(tips, caps, false).topLeftCorner<3, 3>();
      // z of H points out of the back of the hand.
      if (R.col(2).dot(sight) < kLeastFacing) continue;
      const Points turned = R * tips;
      const double scale = std::clamp(turned.cwiseProduct(caps).sum() / turned.squaredNorm(),
                                      1 / kMostScale, kMostScale);
      best = std::min(best, (scale * turned - caps).squaredNorm());
    }
    ranked.push_back({order, std::sqrt(best / kNumFingers)});
  } while (std::next_permutation(order.begin(), order.end()));
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const HandLabels& a, const HandLabels& b) { return a.rms < b.rms; });
  return ranked;
}

}  // namespace springgrasp
