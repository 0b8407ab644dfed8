#include "vision/wrist_depth.h"

#include <gtest/gtest.h>

#include "vision/seen_hand.h"

namespace springgrasp {
namespace {

struct WristDepthTest : testing::Test {
  const HandModel model = MakeHandModel(TestHand());
  const StereoCameras eyes = TestEyes();
  const HandFit truth = OpenHand(model);
  Seen seen;

  WristDepthTest() { See(model, truth, eyes, seen); }
  double Depth(const HandFit& fit) const {
    return (eyes.left.X_WC.inverse() * fit.X_WH.translation()).z();
  }
  // The hand turned about its fingertips, so that its wrist is nearer or farther.
  HandFit Turned(double angle) const {
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
    for (const auto& tip : seen.observation.tip_W) pivot += *tip / kNumFingers;
    HandFit fit = truth;
    const Eigen::Matrix3d R =
        Eigen::AngleAxisd(angle, truth.X_WH.linear().col(1)).toRotationMatrix();
    fit.X_WH.linear() = R * truth.X_WH.linear();
    fit.X_WH.translation() = pivot + R * (truth.X_WH.translation() - pivot);
    return fit;
  }
};

TEST_F(WristDepthTest, IsThatOfTheHandSeenWhateverTheFitThinks) {
  for (const double angle : {-0.2, -0.1, 0.0, 0.1, 0.2}) {
    const auto measured = MeasureWristDepth(model, eyes, seen.observation, Turned(angle));
    ASSERT_TRUE(measured) << angle;
    EXPECT_NEAR(measured->depth, Depth(truth), 0.008) << angle;
    EXPECT_LT(measured->sigma, 0.008);
  }
}

TEST_F(WristDepthTest, NeedsBothPicturesAndAFingertip) {
  HandObservation one_eye = seen.observation;
  one_eye.masks[1] = nullptr;
  EXPECT_FALSE(MeasureWristDepth(model, eyes, one_eye, truth));
  HandObservation no_tip = seen.observation;
  for (auto& tip : no_tip.tip_W) tip.reset();
  EXPECT_FALSE(MeasureWristDepth(model, eyes, no_tip, truth));
}

TEST_F(WristDepthTest, SaysNothingAboutAMaskWithoutEdges) {
  for (HandMask& mask : seen.masks) mask.mask.setTo(255);
  EXPECT_FALSE(MeasureWristDepth(model, eyes, seen.observation, truth));
}

}  // namespace
}  // namespace springgrasp
