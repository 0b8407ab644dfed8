#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "experiment/demonstrator_grasp.h"
#include "experiment/demonstrator_recorded.h"
#include "experiment/demonstrator_synthesise.h"
#include "experiment/observe_stage.h"
#include "experiment/synthesised_demonstration.h"
#include "grasp/object_contacts.h"

namespace springgrasp {
namespace {

struct Case {
  const char* type;
  const char* shape;
  double object_size;  // m, between thumb and fingers
};

// A person of another size: the hand that the scene's builder makes of it.
DemonstratorHand HandOfLength(double length) {
  Scene scene;
  scene.demonstrator.hand_length = length;
  return ObserveStage(scene, std::nullopt).hand();
}

class SynthesisedGraspTest : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Types, SynthesisedGraspTest,
                         testing::Values(Case{"pinch", "sphere:0.04", 0.04},
                                         Case{"tripod", "box:0.04x0.04x0.04", 0.04},
                                         Case{"power", "cylinder:0.05x0.16", 0.05},
                                         Case{"lateral", "box:0.08x0.06x0.005", 0.005}));

TEST_P(SynthesisedGraspTest, EndsWithTheInvolvedTipsOnTheObject) {
  const Shape shape = ParseShape(GetParam().shape);
  for (int seed = 0; seed < 6; ++seed) {
    RandomEngine engine = MakeStream(seed, 0, "observation");
    const HandMotion motion = SynthesiseGrasp(SharedHand(), {GetParam().type, shape}, engine);
    const HandMotionSample& last = motion.samples.back();
    const HandShape parts = ComputeHandShape(SharedHand(), last.q);
    Eigen::Vector3d others = Eigen::Vector3d::Zero(), thumb = others;
    for (int f = 0; f < kNumFingers; ++f) {
      const Eigen::Vector3d tip = last.X_WH * parts.tips[f];
      if (!motion.involved[f]) {
        EXPECT_GT(SignedDistance(shape, tip), SharedHand().tip_radius - 0.001) << kFingerNames[f];
        continue;
      }
      EXPECT_NEAR(SignedDistance(shape, tip), SharedHand().tip_radius, 0.001) << kFingerNames[f];
      (f == kThumb ? thumb : others) += OutwardNormal(shape, tip);
    }
    EXPECT_LT(thumb.normalized().dot(others.normalized()), -0.85) << "thumb opposes the fingers";
  }
}

// What is known of human reaches (Ansuini et al. 2015, mocapGrip).
TEST_P(SynthesisedGraspTest, SmallAndLargeHandsHoldTheSameObject) {
  const Shape shape = ParseShape(GetParam().shape);
  for (const double length : {0.165, 0.205}) {
    const DemonstratorHand hand = HandOfLength(length);
    EXPECT_NEAR(hand.tip_radius, SharedHand().tip_radius * length / kMmmHandLength, 1e-12);
    RandomEngine engine = MakeStream(1, 0, "observation");
    const HandMotion motion = SynthesiseGrasp(hand, {GetParam().type, shape}, engine);
    const HandShape parts = ComputeHandShape(hand, motion.samples.back().q);
    for (int f = 0; f < kNumFingers; ++f) {
      if (!motion.involved[f]) continue;
      EXPECT_NEAR(SignedDistance(shape, motion.samples.back().X_WH * parts.tips[f]),
                  hand.tip_radius, 0.001)
          << length << " " << kFingerNames[f];
    }
  }
}

TEST_P(SynthesisedGraspTest, MovesLikeAPerson) {
  const Shape shape = ParseShape(GetParam().shape);
  for (int seed = 0; seed < 6; ++seed) {
    RandomEngine engine = MakeStream(seed, 0, "observation");
    const HandMotion motion = SynthesiseGrasp(SharedHand(), {GetParam().type, shape}, engine);
    std::vector<double> speed, aperture;
    for (std::size_t i = 0; i < motion.samples.size(); ++i) {
      const HandMotionSample& sample = motion.samples[i];
      const HandShape parts = ComputeHandShape(SharedHand(), sample.q);
      aperture.push_back((parts.tips[kThumb] - parts.tips[kIndex]).norm());
      const Eigen::Vector3d step =
          sample.X_WH.translation() - motion.samples[i > 0 ? i - 1 : 0].X_WH.translation();
      speed.push_back(step.norm() * 100);
    }
    const double peak = *std::max_element(speed.begin(), speed.end());
    const auto moving = [&](double v) { return v > 0.05 * peak; };
    const auto first = std::find_if(speed.begin(), speed.end(), moving);
    const auto last = std::find_if(speed.rbegin(), speed.rend(), moving);
    const double begin = double(first - speed.begin()) / 100;
    const double end = double(speed.size() - (last - speed.rbegin())) / 100;
    EXPECT_GT(end - begin, 0.75);
    EXPECT_LT(end - begin, 1.4);
    EXPECT_GT(peak, 0.3);
    EXPECT_LT(peak, 1.0);
    EXPECT_LT(speed.back(), 1e-6) << "at rest in the end";
    const auto widest = std::max_element(aperture.begin(), aperture.end());
    EXPECT_GT(*widest, aperture.front() + 0.01) << "opens before it closes";
    EXPECT_GT(*widest, aperture.back() + 0.01);
    EXPECT_NEAR(*widest, 0.051 + 0.67 * GetParam().object_size, 0.025);
    const double when = (double(widest - aperture.begin()) / 100 - begin) / (end - begin);
    EXPECT_GT(when, 0.5);
    EXPECT_LT(when, 0.9);
  }
}

TEST_P(SynthesisedGraspTest, DependsOnTheEngineAlone) {
  const Shape shape = ParseShape(GetParam().shape);
  const auto end_of = [&](int seed) {
    RandomEngine engine = MakeStream(seed, 0, "observation");
    const HandMotion motion = SynthesiseGrasp(SharedHand(), {GetParam().type, shape}, engine);
    return Eigen::Vector3d(motion.samples[40].X_WH.translation());
  };
  EXPECT_EQ(end_of(3), end_of(3));
  EXPECT_NE(end_of(3), end_of(4));
}

TEST(DemonstratorGraspTest, WhatNobodyCanHoldIsRefused) {
  RandomEngine engine = MakeStream(1, 0, "observation");
  EXPECT_THROW(SynthesiseGrasp(SharedHand(), {"pinch", ParseShape("sphere:0.4")}, engine), Error);
  EXPECT_THROW(SynthesiseGrasp(SharedHand(), {"hug", Shape{}}, engine), Error);
}

TEST(DemonstratorRecordedTest, TheHandFollowsWhatWasRecorded) {
  const std::filesystem::path folder = std::string(SPRINGGRASP_SHARED_DIR) + "/demonstrations";
  if (!std::filesystem::is_directory(folder)) {
    GTEST_SKIP() << "the recordings are not beside the project";
  }
  for (const char* name : {"enclose_03.csv", "pinch_30mm_1.csv", "pinch_40mm_2.csv"}) {
    const Demonstration recording = ReadDemonstration((folder / name).string());
    const HandMotion motion = HandMotionOf(SharedHand(), recording);
    ASSERT_EQ(motion.samples.size(), recording.samples.size());
    std::vector<double> errors;
    for (std::size_t i = 0; i < motion.samples.size(); ++i) {
      const HandMotionSample& sample = motion.samples[i];
      EXPECT_TRUE((sample.q.array() >= SharedHand().tree.lower.array() - 1e-12).all());
      EXPECT_TRUE((sample.q.array() <= SharedHand().tree.upper.array() + 1e-12).all());
      const HandShape parts = ComputeHandShape(SharedHand(), sample.q);
      for (int f = 0; f < kNumFingers; ++f) {
        EXPECT_EQ(sample.recorded[f], recording.samples[i].p_WF[f].has_value());
        if (!sample.recorded[f]) continue;
        errors.push_back((sample.X_WH * parts.tips[f] - *recording.samples[i].p_WF[f]).norm());
      }
    }
    // The MMM thumb is some 20 mm shorter than the thumb of the person who enclosed.
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.005) << name;
    EXPECT_LT(errors[errors.size() * 95 / 100], 0.025) << name;
  }
}

}  // namespace
}  // namespace springgrasp
