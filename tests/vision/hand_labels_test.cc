#include "vision/hand_labels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "vision/hand_pose.h"
#include "vision/synthetic_caps.h"
#include "vision/test_hand.h"

namespace springgrasp {
namespace {

// Caps of a hand before the eyes, palm towards them, bent, turned and measured a little wrong.
struct ShownCaps {
  PerFinger<Eigen::Vector3d> caps;
  PerFinger<int> order;  // entry f: index of finger f's cap
};

ShownCaps Show(const HandModel& model, RandomEngine& engine) {
  HandFit hand;
  const double bend = Uniform(engine, 0.3, 2.4), roll = Uniform(engine, -M_PI, M_PI);
  hand.q = (bend * model.rest).cwiseMax(model.tree.lower).cwiseMin(model.tree.upper);
  for (double& q : hand.q) q += 0.08 * Normal(engine);
  hand.scale = Uniform(engine, 0.9, 1.1);
  // z of H, out of the back of the hand, away from the eyes.
  const Eigen::Vector3d tilt(Uniform(engine, -0.5, 0.5), Uniform(engine, -0.5, 0.5), 0);
  hand.X_WH.linear() =
      ExpRotation(tilt).toRotationMatrix() * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
  hand.X_WH.translation() = Eigen::Vector3d(0, 0, 0.6);
  ShownCaps shown;
  shown.order = {0, 1, 2, 3, 4};
  for (int f = kNumFingers - 1; f > 0; --f) {
    std::swap(shown.order[f], shown.order[static_cast<int>(Uniform(engine, 0, f + 1))]);
  }
  for (int f = 0; f < kNumFingers; ++f) {
    shown.caps[shown.order[f]] =
        FittedTip(model, hand, f) +
        0.0015 * Eigen::Vector3d(Normal(engine), Normal(engine), Normal(engine));
  }
  return shown;
}

TEST(RankLabelsTest, HandsBeforeTheEyesAreLabelledRightHoweverTheyLie) {
  const HandModel model = MakeHandModel(TestHand());
  const StereoCameras eyes = TestEyes();
  RandomEngine engine = MakeStream(1, 0, "labels");
  constexpr int kDraws = 200;
  int first = 0, among_three = 0;
  for (int i = 0; i < kDraws; ++i) {
    const ShownCaps shown = Show(model, engine);
    const auto ranked = RankLabels(model, eyes, shown.caps);
    ASSERT_EQ(ranked.size(), 120U);
    first += ranked[0].order == shown.order;
    among_three += std::any_of(ranked.begin(), ranked.begin() + 3,
                               [&](const auto& labels) { return labels.order == shown.order; });
  }
  EXPECT_GE(first, 0.95 * kDraws);
  EXPECT_GE(among_three, 0.98 * kDraws);
}

TEST(RankLabelsTest, TheMirrorImageOfAHandFitsWorse) {
  const HandModel model = MakeHandModel(TestHand());
  const StereoCameras eyes = TestEyes();
  RandomEngine engine = MakeStream(2, 0, "labels");
  for (int i = 0; i < 20; ++i) {
    ShownCaps shown = Show(model, engine);
    const double right = RankLabels(model, eyes, shown.caps)[0].rms;
    for (auto& cap : shown.caps) cap.x() = -cap.x();
    EXPECT_GT(RankLabels(model, eyes, shown.caps)[0].rms, right);
  }
}

}  // namespace
}  // namespace springgrasp
