#include "grasp/generate.h"

#include <gtest/gtest.h>

#include <map>

#include "base/error.h"
#include "base/files.h"
#include "grasp/learn.h"
#include "synthetic_demonstration.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

// A demonstration at 100 Hz without noise of each type, learned once.
const Grasp& Learned(const std::string& type) {
  static std::map<std::string, Grasp> library;
  const auto found = library.find(type);
  if (found != library.end()) return found->second;
  SyntheticGrasp grasp;
  grasp.type = type;
  grasp.shape = ParseShape(type == "power" ? "cylinder:0.05x0.2" : "sphere:0.04");
  RandomEngine engine = MakeStream(1, 0, "generate_test");
  LearnOptions options;
  options.type = type;
  return library.emplace(type, LearnGrasp(MakeDemonstration(grasp, engine), options)).first->second;
}

double Span(const PerFinger<Vector3d>& p, const PerFinger<bool>& involved) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (int i = kIndex; i < kNumFingers; ++i) {
    if (!involved[i]) continue;
    sum += p[i];
    ++count;
  }
  return (sum / count - p[kThumb]).norm();
}

struct Course {
  double start = 0, peak = 0, t_peak = 0, end = 0;  // m, s
  double error_at_T = 0, error_after_T = 0;         // largest distance from a contact, m
};

Course CourseOf(const FingertipMotion& motion) {
  Course course;
  course.start = Span(motion.samples.front().p_HF, motion.involved);
  for (const FingertipMotionSample& sample : motion.samples) {
    const double span = Span(sample.p_HF, motion.involved);
    if (span > course.peak) {
      course.peak = span;
      course.t_peak = sample.t;
    }
    if (sample.t < motion.T - 1e-6) continue;
    double error = 0;
    for (int i = 0; i < kNumFingers; ++i) {
      if (!motion.involved[i]) continue;
      error = std::max(error, (motion.X_HO.inverse() * sample.p_HF[i] - motion.p_OC[i]).norm());
    }
    if (course.error_after_T == 0 && course.error_at_T == 0) {
      course.error_at_T = error;
      course.end = span;
    }
    course.error_after_T = std::max(course.error_after_T, error);
  }
  return course;
}

struct Case {
  std::string type, shape;
};

class GenerateMotionTest : public testing::TestWithParam<Case> {};

TEST_P(GenerateMotionTest, FingersOpenThenCloseOnTheContactsAndStay) {
  const Grasp& grasp = Learned(GetParam().type);
  for (const double duration : {0.8, 1.2, 2.0}) {
    GenerateOptions options;
    options.shape = ParseShape(GetParam().shape);
    options.X_WO = MakePose(Vector3d(0.1, 0.7, 0.9), ExpRotation(Vector3d(0, 0, 0.5)));
    options.duration = duration;
    options.tip_radius = 0.01;
    const FingertipMotion motion = GenerateMotion(grasp, options);
    const Course course = CourseOf(motion);
    EXPECT_GT(course.peak, course.start + 0.005) << duration;
    EXPECT_GT(course.peak, course.end + 0.005) << duration;
    EXPECT_GT(course.t_peak, 0.1 * duration);
    EXPECT_LT(course.t_peak, 0.9 * duration);
    EXPECT_LT(course.error_at_T, 0.002) << duration;
    EXPECT_LT(course.error_after_T, 0.002) << duration;
  }
}

TEST_P(GenerateMotionTest, ContactsLieOneTipRadiusOutsideTheNewObject) {
  GenerateOptions options;
  options.shape = ParseShape(GetParam().shape);
  options.tip_radius = 0.011;
  const FingertipMotion motion = GenerateMotion(Learned(GetParam().type), options);
  for (int i = 0; i < kNumFingers; ++i) {
    if (!motion.involved[i]) continue;
    EXPECT_NEAR(SignedDistance(motion.shape, motion.p_OC[i]), 0.011, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Objects, GenerateMotionTest,
    testing::Values(Case{"pinch", "sphere:0.02"}, Case{"pinch", "sphere:0.03"},
                    Case{"pinch", "sphere:0.06"}, Case{"pinch", "sphere:0.08"},
                    Case{"pinch", "box:0.04x0.06x0.05"}, Case{"tripod", "sphere:0.02"},
                    Case{"tripod", "sphere:0.05"}, Case{"tripod", "sphere:0.08"},
                    Case{"power", "cylinder:0.03x0.2"}, Case{"power", "cylinder:0.06x0.15"},
                    Case{"power", "cylinder:0.08x0.2"}));

// Hands open widest at 60 to 75 % of a reach, and hold what they have closed on.
TEST(GenerateTest, ApertureAndLandingFollowPeopleForEverySizeAndSpeed) {
  for (const char* type : {"pinch", "power"}) {
    for (const double width : {0.02, 0.04, 0.06}) {
      for (const double duration : {0.6, 1.0, 2.0}) {
        SCOPED_TRACE(fmt::format("{} of {} m in {} s", type, width, duration));
        GenerateOptions options;
        options.shape = type == std::string("power")
                            ? ParseShape(fmt::format("cylinder:{}x0.2", width))
                            : ParseShape(fmt::format("sphere:{}", width));
        options.duration = duration;
        const FingertipMotion motion = GenerateMotion(Learned(type), options);
        const Course course = CourseOf(motion);
        EXPECT_GT(course.peak, course.start + 0.005);
        EXPECT_GT(course.t_peak, 0.60 * duration);
        EXPECT_LT(course.t_peak, 0.75 * duration);
        EXPECT_LT(course.error_after_T, 0.001);
      }
    }
  }
}

TEST(GenerateTest, SlowerMovementFollowsTheSamePath) {
  const Grasp& grasp = Learned("pinch");
  GenerateOptions options;
  options.shape = grasp.shape;
  const FingertipMotion a = GenerateMotion(grasp, options);
  options.duration = 2 * a.T;
  options.dt = 0.01;
  const FingertipMotion b = GenerateMotion(grasp, options);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t n = 0; n < a.samples.size(); n += 10) {
    EXPECT_LT((a.samples[n].X_WH.translation() - b.samples[n].X_WH.translation()).norm(), 1e-5);
    for (int i = 0; i < kNumFingers; ++i) {
      EXPECT_LT((a.samples[n].p_HF[i] - b.samples[n].p_HF[i]).norm(), 2e-4) << n << " " << i;
    }
  }
}

TEST(GenerateTest, MovingTheObjectMovesEverythingWithIt) {
  const Grasp& grasp = Learned("tripod");
  GenerateOptions options;
  options.shape = ParseShape("sphere:0.05");
  const FingertipMotion a = GenerateMotion(grasp, options);
  const Pose X = MakePose(Vector3d(0.3, -0.2, 1.1), ExpRotation(Vector3d(0, 0, 2.0)));
  options.X_WO = X;
  const FingertipMotion b = GenerateMotion(grasp, options);
  for (std::size_t n = 0; n < a.samples.size(); n += 20) {
    EXPECT_LT(((X * a.samples[n].X_WH).matrix() - b.samples[n].X_WH.matrix()).norm(), 1e-6);
    for (int i = 0; i < kNumFingers; ++i) {
      EXPECT_LT((a.samples[n].p_HF[i] - b.samples[n].p_HF[i]).norm(), 1e-6);
    }
  }
}

TEST(GenerateTest, YawTurnsTheReachAboutTheObject) {
  const Grasp& grasp = Learned("pinch");
  GenerateOptions options;
  options.shape = grasp.shape;
  const FingertipMotion a = GenerateMotion(grasp, options);
  options.yaw = 1.0;
  const FingertipMotion b = GenerateMotion(grasp, options);
  const Pose turn = MakePose(Vector3d::Zero(), ExpRotation(Vector3d(0, 0, 1.0)));
  EXPECT_LT(((turn * a.samples[50].X_WH).matrix() - b.samples[50].X_WH.matrix()).norm(), 1e-6);
  EXPECT_LT((turn * a.p_OC[kIndex] - b.p_OC[kIndex]).norm(), 1e-9);
  // X_HO still puts the contacts where the fingers close.
  const Pose X_WH = b.samples.back().X_WH;
  EXPECT_LT(((b.X_WO * b.X_HO.inverse()).translation() - X_WH.translation()).norm(), 2e-3);
}

TEST(GenerateTest, MovedStartIsKeptAndItsOffsetDecays) {
  const Grasp& grasp = Learned("pinch");
  GenerateOptions options;
  options.shape = grasp.shape;
  const FingertipMotion a = GenerateMotion(grasp, options);
  options.X_WG_start =
      MakePose(Vector3d(0.1, -0.05, 0.05), Eigen::Quaterniond::Identity()) * a.samples.front().X_WG;
  const FingertipMotion b = GenerateMotion(grasp, options);
  EXPECT_LT((b.samples.front().X_WG.translation() - options.X_WG_start->translation()).norm(),
            1e-9);
  double last = 1;
  for (std::size_t n = 0; n < a.samples.size(); n += 20) {
    const double offset =
        (a.samples[n].X_WG.translation() - b.samples[n].X_WG.translation()).norm();
    EXPECT_LE(offset, last + 1e-9);
    last = offset;
  }
  EXPECT_LT(last, 0.001);
  const Course course = CourseOf(b);
  EXPECT_GT(course.peak, course.start + 0.005);
  EXPECT_LT(course.error_at_T, 0.002);
}

TEST(GenerateTest, ARayThatMissesFallsBackToTheMeanRadius) {
  Grasp grasp = Learned("pinch");
  grasp.rays[kIndex].direction.setZero();
  grasp.rays[kThumb].direction = -Vector3d::UnitX();
  const PerFinger<Contact> contacts = ContactsOn(grasp, ParseShape("sphere:0.04"), 0.01);
  EXPECT_TRUE(contacts[kIndex].p_OC.allFinite());
  EXPECT_NEAR(contacts[kThumb].p_OC.norm(), 0.03, 1e-9);
}

// Eq. (6): without contact points the fingers come to rest on the circle about the centre.
TEST(GenerateTest, TheObjectsCentreAloneClosesTheHandOnItsMeanRadius) {
  for (const char* type : {"pinch", "tripod"}) {
    GenerateOptions options;
    options.shape = ParseShape("sphere:0.05");
    options.object_centre = true;
    const FingertipMotion motion = GenerateMotion(Learned(type), options);
    const double radius = 0.025 + options.tip_radius;
    double widest = 0;
    for (const FingertipMotionSample& sample : motion.samples) {
      widest = std::max(widest, Span(sample.p_HF, motion.involved));
    }
    for (int i = 0; i < kNumFingers; ++i) {
      if (!motion.involved[i]) continue;
      const Vector3d end = motion.X_HO.inverse() * motion.samples.back().p_HF[i];
      EXPECT_NEAR(end.norm(), radius, 0.001) << type << " " << i;
      EXPECT_LT((end - motion.p_OC[i]).norm(), 1e-12);
    }
    EXPECT_GT(widest, Span(motion.samples.back().p_HF, motion.involved) + 0.005);
    EXPECT_LT(motion.p_OC[kThumb].dot(motion.p_OC[kIndex]), 0);  // on either side
  }
}

TEST(GenerateTest, AWayBackThatLeadsAFingerAstrayIsTakenStraight) {
  Grasp grasp = Learned("pinch");
  GenerateOptions options;
  options.shape = grasp.shape;
  const Course straight = CourseOf(GenerateMotion(grasp, options));
  // Beyond 1 / |bend| from the contact the way back points away from it.
  for (const int i : {kThumb, kIndex}) grasp.bend[i] = 2000 * grasp.opening[i].normalized();
  const FingertipMotion motion = GenerateMotion(grasp, options);
  for (const FingertipMotionSample& sample : motion.samples) {
    for (const Vector3d& tip : sample.p_HF) EXPECT_LT(tip.norm(), 0.3);
  }
  EXPECT_LT(CourseOf(motion).error_after_T, 2 * straight.error_after_T + 0.001);
}

TEST(GenerateTest, FingersOfTheLibraryLandInTimeFromAnywhere) {
  for (const char* type : {"pinch", "tripod", "power", "lateral", "side/tripod"}) {
    const Grasp grasp = ReadGrasp(SourceFolder() + "/models/grasps/" + type + ".yaml");
    GenerateOptions options;
    options.shape = grasp.shape;
    options.similar_reach = true;
    RandomEngine engine = MakeStream(1, 0, "generate_test");
    for (int n = 0; n < 10; ++n) {
      const Vector3d turn(Uniform(engine, -0.6, 0.6), Uniform(engine, -0.6, 0.6),
                          Uniform(engine, -0.6, 0.6));
      options.X_WG_start = MakePose({Uniform(engine, -0.3, 0.1), Uniform(engine, -0.4, -0.1), 0.2},
                                    ExpRotation(turn));
      EXPECT_LT(CourseOf(GenerateMotion(grasp, options)).error_at_T, 0.005) << type << " " << n;
    }
  }
}

TEST(GenerateTest, ImpossibleRequestsAreErrors) {
  GenerateOptions options;
  options.duration = -1.0;
  EXPECT_THROW(GenerateMotion(Learned("pinch"), options), Error);
  options.duration = 1.0;
  options.dt = 0;
  EXPECT_THROW(GenerateMotion(Learned("pinch"), options), Error);
}

TEST(GenerateTest, CsvHasARowPerSample) {
  GenerateOptions options;
  options.shape = ParseShape("sphere:0.04");
  const FingertipMotion motion = GenerateMotion(Learned("pinch"), options);
  const std::string text = FormatFingertipMotion(motion);
  const auto rows = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  EXPECT_EQ(rows, motion.samples.size() + 4);
  EXPECT_NE(text.find("t,f_cen,grasp_x"), std::string::npos);
}

}  // namespace
}  // namespace springgrasp
