#include "vision/hand_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "vision/seen_hand.h"
#include "vision/synthetic_caps.h"
#include "vision/test_hand.h"

namespace springgrasp {
namespace {

double TurnDeg(const HandFit& a, const HandFit& b) {
  return RotationDistance(Eigen::Quaterniond(a.X_WH.linear()),
                          Eigen::Quaterniond(b.X_WH.linear())) *
         180 / M_PI;
}

// An open hand before two eyes, and what they see of it.
class HandPoseTest : public testing::Test {
 protected:
  const HandModel model = MakeHandModel(TestHand());
  const StereoCameras eyes = TestEyes();
  HandFit truth = OpenHand(model);
  Seen seen;
};

TEST_F(HandPoseTest, AnOpenHandIsFoundWithoutAGuess) {
  See(model, truth, eyes, seen);
  const auto fit = StartHandFit(model, eyes, seen.observation);
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->X_WH.translation() - truth.X_WH.translation()).norm(), 0.012);
  EXPECT_LT(TurnDeg(*fit, truth), 10);
  EXPECT_NEAR(fit->scale, 1, 0.05);
  EXPECT_LT(fit->tip_rms, 0.004);
}

TEST_F(HandPoseTest, AFitThatWentAstrayIsFoundAgainAndAGoodOneIsKept) {
  See(model, truth, eyes, seen);
  HandFit good = UpdateHandFit(model, eyes, seen.observation, truth, {}, false);
  EXPECT_FALSE(RestartHandFit(model, eyes, seen.observation, good));
  HandFit astray = truth;
  astray.X_WH.translation() += Eigen::Vector3d(0.05, 0.03, 0.05);
  astray.X_WH.linear() =
      Eigen::AngleAxisd(0.9, Eigen::Vector3d::UnitZ()).toRotationMatrix() * truth.X_WH.linear();
  const auto fit = RestartHandFit(model, eyes, seen.observation, astray);
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->X_WH.translation() - truth.X_WH.translation()).norm(), 0.015);
  EXPECT_LT(TurnDeg(*fit, truth), 12);
}

TEST_F(HandPoseTest, AMovingHandIsFollowed) {
  HandFit fit = truth;
  HandStep step;
  for (int k = 0; k < 12; ++k) {
    truth.X_WH.translation() += Eigen::Vector3d(-0.006, 0.002, -0.002);
    truth.X_WH.linear() =
        Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ()).toRotationMatrix() * truth.X_WH.linear();
    truth.q = (truth.q.array() + 0.03).matrix().cwiseMin(model.tree.upper);
    See(model, truth, eyes, seen);
    const Eigen::Vector3d before = fit.X_WH.translation();
    fit = UpdateHandFit(model, eyes, seen.observation, fit, step, false);
    step.position = fit.X_WH.translation() - before;
  }
  EXPECT_TRUE(fit.has_orientation);
  EXPECT_LT((fit.X_WH.translation() - truth.X_WH.translation()).norm(), 0.012);
  EXPECT_LT(TurnDeg(fit, truth), 10);
}

TEST_F(HandPoseTest, AnObjectInFrontOfTheHandDoesNotPushItAway) {
  // A post between the eyes and the palm.
  DemonstratedObject post{ParseShape("cylinder:0.05x0.3"), Pose::Identity()};
  post.X_WO.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
  post.X_WO.translation() = truth.X_WH * Eigen::Vector3d(0.05, 0, -0.06);
  See(model, truth, eyes, seen);
  const KnownObject known{post, {SeeObject(eyes.left, post), SeeObject(eyes.right, post)}};
  int hidden = 0;
  for (int v = 0; v < 2; ++v) {
    cv::Mat& mask = seen.masks[v].mask;
    for (int i = 0; i < mask.rows; ++i) {
      for (int j = 0; j < mask.cols; ++j) {
        if (!known.depth[v].Covers({2.0 * j, 2.0 * i})) continue;
        hidden += mask.at<std::uint8_t>(i, j) > 0;
        mask.at<std::uint8_t>(i, j) = 0;
      }
    }
  }
  ASSERT_GT(hidden, 500);
  seen.observation.object = &known;
  HandFit fit = truth;
  for (int k = 0; k < 20; ++k) fit = UpdateHandFit(model, eyes, seen.observation, fit, {}, false);
  EXPECT_LT((fit.X_WH.translation() - truth.X_WH.translation()).norm(), 0.005);
}

TEST_F(HandPoseTest, WithTwoTipsThePictureGoesOn) {
  See(model, truth, eyes, seen);
  for (int f = kMiddle; f < kNumFingers; ++f) seen.observation.tip_W[f].reset();
  const HandFit fit = UpdateHandFit(model, eyes, seen.observation, truth, {}, false);
  EXPECT_FALSE(fit.has_orientation);
  EXPECT_LT((fit.X_WH.translation() - truth.X_WH.translation()).norm(), 0.012);
  EXPECT_FALSE(StartHandFit(model, eyes, seen.observation));
}

TEST_F(HandPoseTest, AHandWithoutFingertipFramesIsRefused) {
  KinematicTree tree = TestHand();
  tree.frames.pop_back();
  EXPECT_THROW(MakeHandModel(tree), Error);
}

TEST(SmoothHandTrackTest, QuadraticMotionIsLeftAloneAndNoiseIsReduced) {
  std::vector<HandSample> track;
  RandomEngine engine = MakeStream(1, 0, "observation");
  double noise_before = 0, noise_after = 0;
  const auto at = [](double t) { return Eigen::Vector3d(0.3 * t * t, 0.1 * t, 0.5); };
  for (int i = 0; i < 60; ++i) {
    const double t = i / 30.0;
    HandSample sample;
    sample.t = t;
    sample.p_WH = at(t);
    sample.R_WH = ExpRotation({0, 0, 0.5 * t});
    track.push_back(sample);
  }
  for (const HandSample& sample : SmoothHandTrack(track)) {
    EXPECT_LT((*sample.p_WH - at(sample.t)).norm(), 1e-6);
    EXPECT_LT(RotationDistance(*sample.R_WH, ExpRotation({0, 0, 0.5 * sample.t})), 1e-6);
  }
  for (HandSample& sample : track) {
    *sample.p_WH += 0.002 * Eigen::Vector3d(Normal(engine), Normal(engine), Normal(engine));
    noise_before += (*sample.p_WH - at(sample.t)).squaredNorm();
  }
  track[20].p_WH.reset();
  const auto smooth = SmoothHandTrack(track);
  EXPECT_FALSE(smooth[20].p_WH);  // missing stays missing
  for (const HandSample& sample : smooth) {
    if (sample.p_WH) noise_after += (*sample.p_WH - at(sample.t)).squaredNorm();
  }
  EXPECT_LT(noise_after, 0.65 * noise_before);
}

}  // namespace
}  // namespace springgrasp
