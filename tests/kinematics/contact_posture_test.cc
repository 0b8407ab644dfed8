#include "kinematics/contact_posture.h"

#include <gmock/gmock.h>

#include <string>
#include <tuple>

#include "base/error.h"
#include "kinematics/power_posture.h"
#include "posture_requests.h"

namespace springgrasp {
namespace {

using ::testing::Combine;
using ::testing::Values;

bool WithinRanges(const Eigen::VectorXd& q) {
  const KinematicTree& tree = TestRobotHand().tree;
  return (q.array() >= tree.lower.array()).all() && (q.array() <= tree.upper.array()).all();
}

TEST(ShapeDistanceTest, GradientIsTheSlopeOfTheDistance) {
  RandomEngine engine = MakeStream(1, 0, "distance");
  for (const char* text : {"sphere:0.05", "cylinder:0.04x0.1", "box:0.03x0.05x0.08"}) {
    const Shape shape = ParseShape(text);
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Vector3d p(0.1 * Normal(engine), 0.1 * Normal(engine), 0.1 * Normal(engine));
      Eigen::Vector3d n;
      SignedDistance(shape, p, &n);
      EXPECT_NEAR(n.norm(), 1, 1e-12);
      const double h = 1e-7;
      const double slope =
          (SignedDistance(shape, p + h * n) - SignedDistance(shape, p - h * n)) / (2 * h);
      EXPECT_NEAR(slope, 1, 1e-6) << text << " at " << p.transpose();
    }
  }
}

TEST(ShapeDistanceTest, KnownPointsOfACylinder) {
  const Shape shape = ParseShape("cylinder:0.04x0.1");
  EXPECT_NEAR(SignedDistance(shape, {0.05, 0, 0}), 0.03, 1e-12);
  EXPECT_NEAR(SignedDistance(shape, {0, 0, 0.08}), 0.03, 1e-12);
  EXPECT_NEAR(SignedDistance(shape, {0.05, 0, 0.09}), 0.05, 1e-12);
  EXPECT_NEAR(SignedDistance(shape, {0, 0, 0}), -0.02, 1e-12);
}

class FingertipPostureTest
    : public ::testing::TestWithParam<std::tuple<std::string, std::string, int>> {};

TEST_P(FingertipPostureTest, PadsLieOnTheContactsAndNothingElseTouches) {
  const auto& [type, text, direction] = GetParam();
  const Eigen::Vector3d wrist =
      direction == 0 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(0, -1, 0);
  const ContactRequest request = MakeRequest(type, ParseShape(text), wrist);
  const ContactPosture posture = SolveContactPosture(TestRobotHand(), request);
  EXPECT_TRUE(WithinRanges(posture.q));
  for (int f = 0; f < kNumFingers; ++f) {
    EXPECT_LT(std::abs(posture.gap[f]), 0.0005) << kFingerNames[f];  // uninvolved: 0
  }
  // Tripod contacts were asked 24 mm apart, the robot's fingers are 27 mm apart; and three pads lie
  // deeper by 6 degrees each than opposed ones.
  EXPECT_LT(posture.slide, type == "pinch" ? 0.001 : 0.005);
  EXPECT_LT(posture.penetration, 0.001);
  EXPECT_GT(posture.opposition_deg, type == "pinch" ? 170 : 165);
  // On faces, and across a cylinder seen along its axis, normals stay opposed wherever pads lie.
  if (type == "tripod" && request.shape.kind == Shape::Kind::kSphere) {
    EXPECT_LT(posture.opposition_deg, 175);
  }
  EXPECT_GT(posture.clearance, 0.008);
  // The wrist lies where the demonstrated one lay, about the contact line.
  const Pose X_OH = posture.X_HO.inverse();
  const Eigen::Vector3d towards = (X_OH.translation() - request.X_OG.translation()).normalized();
  EXPECT_NEAR(towards.dot(request.X_OG.linear().col(1)), 0, 0.05);
  EXPECT_GT(towards.dot(request.X_OG.linear().col(2)), 0.3);
}

INSTANTIATE_TEST_SUITE_P(Objects, FingertipPostureTest,
                         Combine(Values("pinch", "tripod"),
                                 Values("sphere:0.04", "sphere:0.06", "cylinder:0.05x0.1",
                                        "box:0.03x0.06x0.08", "box:0.04x0.04x0.04"),
                                 Values(0, 1)));

TEST(ContactPostureTest, PinchesFromTwentyToSixtyMillimetres) {
  for (double size = 0.02; size < 0.061; size += 0.01) {
    const Shape shape{Shape::Kind::kBox, Eigen::Vector3d(size, 0.04, 0.06)};
    const ContactPosture posture =
        SolveContactPosture(TestRobotHand(), MakeRequest("pinch", shape, {0, -0.6, 0.8}));
    EXPECT_LT(std::abs(posture.gap[kThumb]) + std::abs(posture.gap[kIndex]), 0.001) << size;
    EXPECT_LT(posture.slide, 0.001) << size;
    EXPECT_LT(posture.penetration, 0.001) << size;
  }
}

TEST(ContactPostureTest, SkewedContactsSlideUntilTheyOppose) {
  const ContactRequest request =
      MakeRequest("pinch", ParseShape("box:0.04x0.06x0.08"), {0, -1, 0}, 0.006);
  const ContactPosture posture = SolveContactPosture(TestRobotHand(), request);
  const Eigen::Vector3d line = (posture.p_OC[kIndex] - posture.p_OC[kThumb]).normalized();
  EXPECT_GT(line.x(), 0.99);
  EXPECT_GT(posture.slide, 0.003);
  EXPECT_LT(posture.slide, 0.010);
}

// Thumb from -x, the thumb's side of the hand towards -x of O.
TEST(ContactPostureTest, LateralHoldsAPlateOnTheIndexsRadialSide) {
  const RobotHand& hand = TestOppositionHand();
  for (const double thickness : {0.002, 0.005, 0.01}) {
    const Shape plate{Shape::Kind::kBox, Eigen::Vector3d(thickness, 0.16, 0.06)};
    ContactRequest request = MakeRequest("lateral", plate, {0, 0.7, 0.7});
    for (const int f : {kThumb, kIndex}) request.p_OC[f].y() += 0.065;
    request.X_OG.translation().y() += 0.065;
    request.human = TargetFromHuman(TestHumanHand(), TestHumanHand().rest, hand);
    const ContactPosture posture = SolveContactPosture(hand, request);
    EXPECT_LT(std::abs(posture.gap[kThumb]), 0.0005) << thickness;
    EXPECT_LT(std::abs(posture.gap[kIndex]), 0.0005) << thickness;
    EXPECT_LT(posture.penetration, 0.002) << thickness;
    EXPECT_GT(posture.opposition_deg, 170) << thickness;
    // The index pushes along its radial axis, y of H, as the verdict asks.
    const Eigen::Vector3d push_H = posture.X_HO.linear() * Eigen::Vector3d(-1, 0, 0);
    EXPECT_GT(push_H.y(), std::cos(0.5)) << thickness;
    EXPECT_GT(posture.q[hand.opposition], 0.8) << thickness;
  }
}

class PowerPostureTest : public ::testing::TestWithParam<std::string> {};

// Bends are limited so that thumb and fingers do not cross; gripping then pulls the object in.
constexpr double kMaxPalmGap = 0.015;  // m

TEST_P(PowerPostureTest, TheObjectLiesBetweenThumbPalmAndFingers) {
  const ContactRequest request = MakeRequest("power", ParseShape(GetParam()), {0, -1, 0});
  const ContactPosture posture = SolveContactPosture(TestRobotHand(), request);
  EXPECT_TRUE(WithinRanges(posture.q));
  int touching = 0;
  for (int f = kIndex; f < kNumFingers; ++f) touching += posture.gap[f] < 0.001 ? 1 : 0;
  EXPECT_LT(posture.gap[kThumb], 0.001);
  EXPECT_GE(touching, 3);
  EXPECT_LT(posture.penetration, 0.001);
  EXPECT_GT(posture.opposition_deg, 130);
  std::vector<Pose> X_HB;
  ForwardKinematics(TestRobotHand().tree, posture.q, X_HB);
  const double palm =
      HandDistance(TestRobotHand(), X_HB, posture.X_HO.inverse(), request.shape, {}, true);
  // Wide objects are carried by the proximal phalanges instead.
  EXPECT_LT(palm, kMaxPalmGap);
}

INSTANTIATE_TEST_SUITE_P(Objects, PowerPostureTest,
                         Values("cylinder:0.04x0.18", "cylinder:0.05x0.18", "cylinder:0.06x0.18",
                                "cylinder:0.065x0.2", "cylinder:0.08x0.2", "sphere:0.06",
                                "sphere:0.08", "box:0.04x0.06x0.16"));

TEST(PowerPostureTest, JointsOnOneValveAreBentAlikeUntilThePhalanxIsStopped) {
  const RobotHand& hand = TestRobotHand();
  for (const char* text : {"cylinder:0.04x0.18", "cylinder:0.05x0.18", "sphere:0.07"}) {
    const ContactRequest request = MakeRequest("power", ParseShape(text), {0, -1, 0});
    const ContactPosture posture = SolveContactPosture(hand, request);
    std::vector<Pose> X_HB;
    ForwardKinematics(hand.tree, posture.q, X_HB);
    for (const int f : {kRing, kPinkie}) {
      ASSERT_TRUE(OnOneValve(hand, f));
      const double proximal = posture.q[hand.fingers[f].j0], distal = posture.q[hand.fingers[f].j1];
      EXPECT_GE(distal, proximal - 1e-9) << text;
      if (distal < proximal + 1e-3) continue;
      const FingerTouch touch = TouchOf(hand, f, posture.X_HO.inverse(), request.shape, X_HB);
      EXPECT_LT(touch.proximal, 0.001) << text << " " << kFingerNames[f];
    }
  }
}

TEST(ContactPostureTest, TheFrameOfTheGraspPutsTheObjectRight) {
  const ContactRequest request = MakeRequest("pinch", ParseShape("sphere:0.04"), {0, 0, 1});
  const ContactPosture posture = SolveContactPosture(TestRobotHand(), request);
  const Pose X_OH = request.X_OG * posture.X_HG.inverse();
  EXPECT_LT((X_OH.matrix() - posture.X_HO.inverse().matrix()).norm(), 1e-9);
}

TEST(ContactPostureTest, TheContactFrameLiesAlongTheContactsNotAlongTheDemonstratedOnes) {
  const ContactRequest request = MakeTurnedPinch(ParseShape("box:0.005x0.06x0.08"), 0.6);
  const ContactPosture posture = SolveContactPosture(TestRobotHand(), request);
  const Pose X_OC = posture.X_HO.inverse() * ContactFrame(request.shape, posture);
  EXPECT_LT((X_OC.linear().col(0) - Eigen::Vector3d::UnitX()).norm(), 1e-6);
  EXPECT_LT((X_OC.translation() - posture.p_OC[kThumb]).norm(), 1e-9);
  EXPECT_GT(X_OC.linear().col(2).dot(request.X_OG.linear().col(2)), 0.8);
  const Pose X_OG = posture.X_HO.inverse() * posture.X_HG;
  EXPECT_LT(X_OG.linear().col(0).x(), 0.95) << "the case must tell the two frames apart";
}

TEST(ContactPostureTest, IsTheSameEveryTime) {
  const ContactRequest request = MakeRequest("power", ParseShape("sphere:0.07"), {0, -1, 0});
  const ContactPosture a = SolveContactPosture(TestRobotHand(), request);
  const ContactPosture b = SolveContactPosture(TestRobotHand(), request);
  EXPECT_EQ(a.q, b.q);
  EXPECT_EQ(a.X_HO.matrix(), b.X_HO.matrix());
}

TEST(ContactPostureTest, RefusesUnknownTypesAndMissingThumbs) {
  ContactRequest request = MakeRequest("pinch", ParseShape("sphere:0.04"), {0, 0, 1});
  request.type = "poke";
  EXPECT_THROW(SolveContactPosture(TestRobotHand(), request), Error);
  request.type = "pinch";
  request.involved[kThumb] = false;
  EXPECT_THROW(SolveContactPosture(TestRobotHand(), request), Error);
}

}  // namespace
}  // namespace springgrasp
