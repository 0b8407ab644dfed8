#include "experiment/finger_baseline.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/files.h"
#include "experiment/grasp_requests.h"
#include "grasp/generate.h"
#include "grasp/library.h"
#include "grasp/shown_reach.h"
#include "kinematics/hand_ik.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

// A shipped grasp, planned as far as the fingers, on an object of the given shape.
struct Fingers {
  explicit Fingers(const std::string& type, const std::string& shape = "")
      : simulation(BuildModel(ReadScene(SourceFolder() + "/scenes/pinch_ball.yaml"), {})),
        body(MakeRobotBody(simulation)),
        human(ScaledHand(body.human, 1)),
        path(ShippedLibrary() + "/" + type + ".yaml"),
        grasp(ReadGrasp(path)) {
    GenerateOptions options;
    options.shape = shape.empty() ? grasp.shape : ParseShape(shape);
    options.tip_radius = body.hand.tip_radius;
    options.dt = 0.02;
    motion = GenerateMotion(grasp, options);
    const Eigen::VectorXd q_human =
        SolveHandMotion(human, TipsOf(motion))[ContactSample(motion, options.dt)];
    posture = SolveContactPosture(body.hand, RequestContacts(human, body.hand, motion, q_human));
  }

  std::vector<Eigen::VectorXd> By(const BaselineRequest& request) const {
    return PlanBaselineHand(request, body, human, grasp, motion, posture);
  }
  // Of the involved tips at the end from the planned contacts, m.
  double OffContacts(const Eigen::VectorXd& q) const {
    const PerFinger<Eigen::Vector3d> tips = TipPositions(body.hand, q);
    double worst = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      if (!motion.involved[f]) continue;
      worst = std::max(worst, (tips[f] - posture.X_HO * posture.p_OC[f]).norm());
    }
    return worst;
  }

  Simulation simulation;
  RobotBody body;
  HumanHand human;
  std::string path;
  Grasp grasp;
  FingertipMotion motion;
  ContactPosture posture;
};

TEST(FingerBaselineTest, InterpolationRunsStraightFromTheOpenHand) {
  const Fingers fingers("pinch");
  const auto q = fingers.By({"interpolation", {}, {}});
  ASSERT_EQ(q.size(), fingers.motion.samples.size());
  EXPECT_LT((q.front() - fingers.body.hand.open).norm(), 1e-9);
  const Eigen::VectorXd way = q.back() - q.front();
  EXPECT_GT(way.norm(), 0.5);
  for (const Eigen::VectorXd& posture : q) {
    const double part = way.dot(posture - q.front()) / way.squaredNorm();
    EXPECT_LT((posture - q.front() - part * way).norm(), 1e-9);
  }
}

TEST(FingerBaselineTest, InterpolationDoesNotSeeTheObject) {
  const auto q = Fingers("pinch").By({"interpolation", {}, {}});
  const auto of_another = Fingers("pinch", "sphere:0.06").By({"interpolation", {}, {}});
  EXPECT_LT((q.back() - of_another.back()).norm(), 1e-9);
}

TEST(FingerBaselineTest, PlaybackEndsOnTheShownObjectAndBesideAnother) {
  const auto off = [](const Fingers& fingers) {
    const Demonstration shown = ReadDemonstration(DemonstrationOfEntry(fingers.path));
    const auto tips = DemonstratedTips(shown, fingers.grasp, 101);
    return fingers.OffContacts(fingers.By({"playback", tips, {}}).back());
  };
  EXPECT_LT(off(Fingers("pinch")), 0.006);
  EXPECT_GT(off(Fingers("pinch", "sphere:0.02")), 0.006);
}

TEST(FingerBaselineTest, TwoSynergiesExplainMostOfTheLibrary) {
  const Fingers fingers("tripod");
  std::vector<Grasp> library;
  for (const LibraryEntry& entry : ReadLibrary(ShippedLibrary())) library.push_back(entry.grasp);
  const PosturalSynergies s = FindSynergies(fingers.body, library);
  EXPECT_LT((s.basis.transpose() * s.basis - Eigen::Matrix2d::Identity()).norm(), 1e-9);
  EXPECT_GT(s.explained, 0.6);
  EXPECT_LE(s.explained, 1);

  // The end is nearer to the contacts than where it starts, and every posture lies in the plane
  // unless a joint is at its stop.
  const auto q = fingers.By({"synergies", {}, s});
  EXPECT_LT(fingers.OffContacts(q.back()), fingers.OffContacts(q.front()));
  for (const Eigen::VectorXd& posture : q) {
    EXPECT_TRUE((posture.array() >= fingers.body.hand.tree.lower.array() - 1e-12).all());
    EXPECT_TRUE((posture.array() <= fingers.body.hand.tree.upper.array() + 1e-12).all());
  }
}

TEST(FingerBaselineTest, AnUnknownNameIsAnError) {
  const Fingers fingers("pinch");
  EXPECT_THROW(fingers.By({"magic", {}, {}}), Error);
  EXPECT_THROW(fingers.By({"playback", {}, {}}), Error);
}

}  // namespace
}  // namespace springgrasp
