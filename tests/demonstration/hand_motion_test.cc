#include "demonstration/hand_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

constexpr double kRate = 100;

// A hand that moves and turns at constant speed while one joint closes.
HandMotion Sliding(double speed) {
  HandMotion motion;
  motion.source = "test";
  motion.object = DemonstratedObject{Shape{}, MakePose({1, 0, 0}, Eigen::Quaterniond::Identity())};
  for (int i = 0; i <= 100; ++i) {
    HandMotionSample sample;
    sample.t = i / kRate;
    sample.X_WH = MakePose({speed * sample.t, 0.2, 0},
                           ExpRotation(0.5 * sample.t * Eigen::Vector3d::UnitZ()));
    sample.q = Eigen::VectorXd::Constant(2, 0.3 * sample.t);
    sample.recorded.fill(i < 50);
    motion.samples.push_back(sample);
  }
  return motion;
}

TEST(HandMotionTest, InterpolationIsExactForConstantVelocity) {
  const HandMotion motion = Sliding(0.7);
  const HandMotionSample sample = Interpolated(motion, 0.3456);
  EXPECT_NEAR(sample.X_WH.translation().x(), 0.7 * 0.3456, 1e-12);
  EXPECT_NEAR(LogRotation(Eigen::Quaterniond(sample.X_WH.linear())).z(), 0.5 * 0.3456, 1e-9);
  EXPECT_NEAR(sample.q[1], 0.3 * 0.3456, 1e-12);
  EXPECT_TRUE(sample.recorded[kThumb]);
  EXPECT_FALSE(Interpolated(motion, 0.4956).recorded[kThumb]);
  EXPECT_EQ(Interpolated(motion, 5).q, motion.samples.back().q);
}

TEST(HandMotionTest, ResamplingHitsTimeZeroAndKeepsTheEnds) {
  const HandMotion even = Resampled(WithLeadIn(Sliding(0.7), Eigen::VectorXd::Zero(2)), 30);
  bool zero = false;
  for (std::size_t i = 1; i < even.samples.size(); ++i) {
    EXPECT_NEAR(even.samples[i].t - even.samples[i - 1].t, 1.0 / 30, 1e-12);
    zero |= even.samples[i].t == 0;
  }
  EXPECT_TRUE(zero);
  EXPECT_NEAR(even.samples.front().t, -0.5, 1e-9);
  EXPECT_NEAR(even.samples.back().t, 1, 1e-9);
}

TEST(HandMotionTest, MovingMovesEverythingTogether) {
  const HandMotion motion = Sliding(0.7);
  const Pose X_VW = MakePose({0.1, 0.2, 0.3}, ExpRotation({1, 0.2, -0.4}));
  const HandMotion moved = Moved(motion, X_VW);
  for (std::size_t i = 0; i < motion.samples.size(); i += 20) {
    const Pose before = motion.object->X_WO.inverse() * motion.samples[i].X_WH;
    const Pose after = moved.object->X_WO.inverse() * moved.samples[i].X_WH;
    EXPECT_TRUE(before.isApprox(after, 1e-12));
  }
  EXPECT_NEAR(moved.up.dot(X_VW.linear() * Eigen::Vector3d::UnitZ()), 1, 1e-12);
}

TEST(HandMotionTest, APeakSpeedStretchesTimeAndNothingElse) {
  const HandMotion motion = Sliding(0.7);
  const HandMotion faster = AtPeakSpeed(motion, 1.4);
  ASSERT_EQ(faster.samples.size(), motion.samples.size());
  EXPECT_NEAR(faster.samples.back().t, 0.5, 1e-9);
  EXPECT_EQ(faster.samples.front().t, 0);
  EXPECT_EQ(faster.samples[30].X_WH.matrix(), motion.samples[30].X_WH.matrix());
  EXPECT_EQ(faster.samples[30].q, motion.samples[30].q);
  EXPECT_THROW(AtPeakSpeed(Sliding(0), 1), Error);
}

// Position, speed and fingers run on without a jump, from an open hand at rest.
TEST(HandMotionTest, LeadInJoinsSmoothlyFromRest) {
  for (const double speed : {0.0, 0.5, 2.0}) {
    const Eigen::VectorXd q_open = Eigen::VectorXd::Constant(2, -0.4);
    const HandMotion motion = WithLeadIn(Sliding(speed), q_open);
    EXPECT_NEAR(motion.samples.front().t, -0.5, 1e-12);
    EXPECT_EQ(motion.samples.front().q, q_open);
    const auto velocity = [&](std::size_t i) -> Eigen::Vector3d {
      return (motion.samples[i + 1].X_WH.translation() - motion.samples[i].X_WH.translation()) *
             kRate;
    };
    EXPECT_LT(velocity(0).norm(), 0.01 + 0.01 * speed);
    // No step in velocity larger than the largest acceleration of a run-up to this speed.
    const double largest = (0.2 + 40 * speed) / kRate;
    double behind = 0;
    for (std::size_t i = 1; i + 1 < motion.samples.size(); ++i) {
      EXPECT_LT((velocity(i) - velocity(i - 1)).norm(), largest) << "speed " << speed;
      behind = std::max(behind, -motion.samples[i].X_WH.translation().x());
    }
    EXPECT_LE(behind, 0.25 * speed) << "the run-up stays short";
    EXPECT_NEAR(velocity(48).x(), speed, 0.05 * speed + 1e-9);
  }
}

}  // namespace
}  // namespace springgrasp
