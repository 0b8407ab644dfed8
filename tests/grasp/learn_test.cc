#include "grasp/learn.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "grasp/generate.h"
#include "synthetic_demonstration.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::Not;

Grasp Learn(const SyntheticGrasp& made, std::uint64_t seed, LearnOptions options = {}) {
  RandomEngine engine = MakeStream(seed, 0, "learn_test");
  options.type = made.type;
  return LearnGrasp(MakeDemonstration(made, engine), options);
}

TEST(LearnTest, FindsFramesContactsAndDurationOfACleanPinch) {
  SyntheticGrasp made;
  made.shape = ParseShape("sphere:0.04");
  made.X_WO = MakePose(Vector3d(0.2, 0.6, 0.9), ExpRotation(Vector3d(0, 0, 0.7)));
  const Grasp grasp = Learn(made, 1);
  EXPECT_TRUE(grasp.object_given);
  EXPECT_NEAR(grasp.scales.T, made.duration, 0.15);
  EXPECT_NEAR(grasp.scales.A, made.start_from.norm(), 0.02);
  const Pose X_OG = grasp.X_OH * grasp.X_HG;
  EXPECT_LT(X_OG.translation().norm(), 0.002);
  EXPECT_LT((X_OG.linear() - SyntheticGraspInObject().linear()).norm(), 0.1);
  EXPECT_NEAR(grasp.rays[kThumb].direction.x(), -1, 0.01);
  EXPECT_NEAR(grasp.rays[kIndex].direction.x(), 1, 0.01);
  EXPECT_LT(grasp.quality.reach_rmse, 0.002);
  EXPECT_EQ(grasp.switch_rule, "fitted");
  for (const int i : {kThumb, kIndex}) EXPECT_LT(grasp.quality.rmse[i], 0.006) << i;
  for (const GraspEdge& edge : grasp.edges) EXPECT_GE(edge.k, 0);
}

TEST(LearnTest, ObjectIsInferredWhereNoneIsGiven) {
  SyntheticGrasp made;
  made.shape = ParseShape("sphere:0.04");
  made.X_WO = MakePose(Vector3d(0.2, 0.6, 0.9), Eigen::Quaterniond::Identity());
  RandomEngine engine = MakeStream(2, 0, "learn_test");
  Demonstration demonstration = MakeDemonstration(made, engine);
  demonstration.object.reset();
  const Grasp grasp = LearnGrasp(demonstration, {});
  EXPECT_FALSE(grasp.object_given);
  EXPECT_NEAR(grasp.shape.size.x(), 0.04, 0.004);  // fingers count as settled at 2 mm
  EXPECT_LT((grasp.X_OH * grasp.X_HG).translation().norm(), 1e-9);
  EXPECT_NEAR(grasp.X_OH.linear().col(1).z(), 1, 0.05);  // y_H is up, so is z_O
}

TEST(LearnTest, LearningTwiceGivesTheSameBytesAndReadsBackTheSame) {
  SyntheticGrasp made;
  made.tip_noise = 0.001;
  const Grasp a = Learn(made, 3);
  const Grasp b = Learn(made, 3);
  EXPECT_TRUE(FormatGrasp(a) == FormatGrasp(b));
  const Grasp c = ParseGrasp(FormatGrasp(a), "a");
  EXPECT_TRUE(FormatGrasp(c) == FormatGrasp(a));
  EXPECT_TRUE(c.X_OH.matrix() == a.X_OH.matrix());
}

TEST(LearnTest, RestLengthsAndTipRadiusFollowTheHandLength) {
  SyntheticGrasp made;
  made.shape = ParseShape("sphere:0.04");
  const Grasp common = Learn(made, 3);
  LearnOptions options;
  options.hand_length = 0.165;
  const Grasp small = Learn(made, 3, options);
  const double factor = 0.165 / common.hand_length;
  EXPECT_NEAR(small.tip_radius, factor * common.tip_radius, 1e-12);
  ASSERT_EQ(small.edges.size(), common.edges.size());
  for (std::size_t i = 0; i < common.edges.size(); ++i) {
    EXPECT_NEAR(small.edges[i].rest_length, factor * common.edges[i].rest_length, 1e-9);
  }
}

struct Observed {
  std::string type, shape;
  double tip_noise, hand_noise, hand_angle, missing;
};

class LearnFromTrackerTest : public testing::TestWithParam<Observed> {};

// Tracker noise at 30 Hz: what is generated for the demonstrated object opens, closes and comes to
// rest where the true contacts are.
TEST_P(LearnFromTrackerTest, GeneratedGraspStillOpensAndClosesOnTheObject) {
  const Observed& observed = GetParam();
  SyntheticGrasp made;
  made.type = observed.type;
  made.shape = ParseShape(observed.shape);
  made.rate = 30;
  made.tip_noise = observed.tip_noise;
  made.hand_noise = observed.hand_noise;
  made.hand_angle_noise = observed.hand_angle;
  made.missing = observed.missing;
  const Grasp grasp = Learn(made, 4);
  EXPECT_NEAR(grasp.quality.noise, observed.tip_noise, 0.6 * observed.tip_noise);
  GenerateOptions options;
  options.shape = made.shape;
  options.tip_radius = made.tip_radius;
  const FingertipMotion motion = GenerateMotion(grasp, options);
  const auto thumb_index = [](const FingertipMotionSample& sample) {
    return (sample.p_HF[kThumb] - sample.p_HF[kIndex]).norm();
  };
  double peak = 0;
  for (const auto& sample : motion.samples) peak = std::max(peak, thumb_index(sample));
  EXPECT_GT(peak, thumb_index(motion.samples.front()) + 0.003);
  EXPECT_GT(peak, thumb_index(motion.samples.back()) + 0.01);
  PerFinger<Vector3d> p_GC, n_G;
  SyntheticContacts(made, p_GC, n_G);
  const FingertipMotionSample& end = motion.samples.back();
  for (int i = 0; i < kNumFingers; ++i) {
    if (!grasp.involved[i]) continue;
    const Vector3d truth = SyntheticGraspInObject() * p_GC[i];
    const Vector3d reached = end.X_WH * end.p_HF[i];
    EXPECT_LT((reached - truth).norm(), 0.012) << kFingerNames[i];
    EXPECT_LT((reached - motion.p_OC[i]).norm(), 0.003) << kFingerNames[i];
  }
}

INSTANTIATE_TEST_SUITE_P(
    Noise, LearnFromTrackerTest,
    testing::Values(Observed{"pinch", "sphere:0.04", 0.002, 0.003, 0.02, 0.05},
                    Observed{"pinch", "sphere:0.04", 0.004, 0.005, 0.05, 0.2},
                    Observed{"tripod", "sphere:0.05", 0.003, 0.004, 0.03, 0.1},
                    Observed{"power", "cylinder:0.05x0.2", 0.002, 0.003, 0.02, 0.05},
                    Observed{"power", "cylinder:0.05x0.2", 0.004, 0.005, 0.05, 0.2}));

TEST(LearnTest, WorksWithoutAWristAndWithoutItsOrientation) {
  for (const bool wrist : {false, true}) {
    SyntheticGrasp made;
    made.wrist = wrist;
    made.orientation = false;
    const Grasp grasp = Learn(made, 5);
    EXPECT_LT((grasp.X_OH * grasp.X_HG).translation().norm(), 0.003);
    GenerateOptions options;
    options.shape = made.shape;
    const FingertipMotion motion = GenerateMotion(grasp, options);
    for (const int i : {kThumb, kIndex}) {
      const FingertipMotionSample& end = motion.samples.back();
      EXPECT_LT((end.X_WH * end.p_HF[i] - motion.p_OC[i]).norm(), 0.003);
    }
  }
}

TEST(LearnTest, PlanarGraspLiesInThePlane) {
  SyntheticGrasp made;
  LearnOptions options;
  options.dim = 2;
  const Grasp grasp = Learn(made, 6, options);
  EXPECT_EQ(grasp.edges.size(), 7u);
  EXPECT_LT(grasp.quality.planarity, 0.003);
  GenerateOptions generate;
  generate.shape = ParseShape("sphere:0.06");
  const FingertipMotion motion = GenerateMotion(grasp, generate);
  for (const int i : {kThumb, kIndex}) {
    const Vector3d reached = motion.X_HO.inverse() * motion.samples.back().p_HF[i];
    EXPECT_LT((reached - motion.p_OC[i]).norm(), 0.002);
  }
}

TEST(LearnTest, PaperProfileHasNoDelayAndNoClosingGain) {
  SyntheticGrasp made;
  LearnOptions options;
  options.profile = "paper";
  const Grasp grasp = Learn(made, 7, options);
  EXPECT_EQ(grasp.delay, 0);
  EXPECT_EQ(grasp.closing, 1);
}

TEST(LearnTest, ReportNamesEveryFingerWithItsError) {
  const std::string report = ReportGrasp(Learn({}, 8));
  EXPECT_THAT(report, HasSubstr("thumb RMSE"));
  EXPECT_THAT(report, HasSubstr("index RMSE"));
  EXPECT_THAT(report, HasSubstr("mm *"));
  EXPECT_THAT(report, HasSubstr("condition number"));
}

TEST(LearnTest, ReportSaysWhichSpringsTheDemonstrationCannotDetermine) {
  Grasp grasp = Learn({}, 8);
  ASSERT_GE(grasp.edges.size(), 4u);
  for (GraspEdge& edge : grasp.edges) {
    edge.k = 0.5;
    edge.standard_error = 0.1;
  }
  EXPECT_THAT(ReportGrasp(grasp), Not(HasSubstr("cannot determine")));
  grasp.edges[0].standard_error = 0.6;
  grasp.edges[3].standard_error = 0;  // not observed
  const std::string report = ReportGrasp(grasp);
  EXPECT_THAT(report, HasSubstr("The data cannot determine the spring thumb-index: 0.5 N/m with a "
                                "standard error of 0.6 N/m.\n"));
  EXPECT_THAT(report, HasSubstr("The data cannot determine the spring thumb-pinkie: its change of "
                                "length shows in no sample.\n"));
  EXPECT_THAT(report, Not(HasSubstr("cannot determine the spring thumb-middle")));
}

TEST(LearnTest, TooLittleToLearnFromIsAnError) {
  RandomEngine engine = MakeStream(9, 0, "learn_test");
  Demonstration demonstration = MakeDemonstration({}, engine);
  LearnOptions options;
  options.type = "clutch";
  EXPECT_THROW(LearnGrasp(demonstration, options), Error);
  options = {};
  options.dim = 4;
  EXPECT_THROW(LearnGrasp(demonstration, options), Error);
  for (auto& sample : demonstration.samples) sample.p_WF[kThumb].reset();
  EXPECT_THROW(LearnGrasp(demonstration, {}), Error);
}

TEST(LearnTest, RealRecordingsAreLearnedAndTransferred) {
  const std::filesystem::path folder =
      std::filesystem::path(SPRINGGRASP_SHARED_DIR) / "demonstrations";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the folder of recordings is not there";
  int learned = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name != "enclose_03.csv" && name != "pinch_30mm_2.csv" && name != "pinch_40mm_2.csv") {
      continue;
    }
    SCOPED_TRACE(name);
    const bool pinch = name.starts_with("pinch");
    LearnOptions options;
    options.type = pinch ? "pinch" : "power";
    const Grasp grasp = LearnGrasp(ReadDemonstration(entry.path().string()), options);
    for (int i = 0; i < kNumFingers; ++i) {
      if (grasp.quality.samples[i] == 0) continue;
      EXPECT_LT(grasp.quality.rmse[i], 0.025) << kFingerNames[i];
    }
    GenerateOptions generate;
    generate.shape = ParseShape(pinch ? "box:0.03x0.03x0.06" : "cylinder:0.06x0.15");
    const FingertipMotion motion = GenerateMotion(grasp, generate);
    for (int i = 0; i < kNumFingers; ++i) {
      if (!grasp.involved[i]) continue;
      const Vector3d reached = motion.X_HO.inverse() * motion.samples.back().p_HF[i];
      EXPECT_LT((reached - motion.p_OC[i]).norm(), 0.003) << kFingerNames[i];
    }
    ++learned;
  }
  EXPECT_EQ(learned, 3);
}

}  // namespace
}  // namespace springgrasp
