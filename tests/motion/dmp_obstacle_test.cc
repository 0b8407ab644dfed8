// Obstacles are passed with the clearance that was asked for, and the goal is still reached.
#include "motion/dmp_obstacle.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "motion/dmp.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

// A learned reach between two places 0.3 to 0.5 m apart, bowed sideways.
Dmp RandomReach(RandomEngine& engine) {
  const Vector3d from(Uniform(engine, -0.4, -0.2), Uniform(engine, -0.1, 0.1),
                      Uniform(engine, -0.1, 0.1));
  const Vector3d to(Uniform(engine, 0.1, 0.2), Uniform(engine, -0.1, 0.1),
                    Uniform(engine, -0.1, 0.1));
  const Vector3d bow(0, Uniform(engine, -0.1, 0.1), Uniform(engine, -0.1, 0.1));
  const double T = Uniform(engine, 0.6, 2);
  const Eigen::Index count = 101;
  MotionSamples samples;
  samples.t = VectorXd::LinSpaced(count, 0, T);
  samples.x.resize(count, 3);
  samples.v.resize(count, 3);
  samples.a.resize(count, 3);
  MotionState start{from, Vector3d::Zero(), Vector3d::Zero()};
  MotionState end{to, Vector3d::Zero(), Vector3d::Zero()};
  const MinimumJerk straight = MakeMinimumJerk(start, end, T);
  const MinimumJerk there = MakeMinimumJerk({Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()},
                                            {bow, Vector3d::Zero(), Vector3d::Zero()}, 0.5 * T);
  for (Eigen::Index i = 0; i < count; ++i) {
    const MotionState s = EvaluateMinimumJerk(straight, samples.t[i]);
    const double t = samples.t[i] < 0.5 * T ? samples.t[i] : T - samples.t[i];
    const double sign = samples.t[i] < 0.5 * T ? 1 : -1;
    const MotionState b = EvaluateMinimumJerk(there, t);
    samples.x.row(i) = (s.x + b.x).transpose();
    samples.v.row(i) = (s.v + sign * b.v).transpose();
    samples.a.row(i) = (s.a + b.a).transpose();
  }
  return LearnDmp(samples);
}

TEST(DmpObstacle, ClearanceIsKeptInTwoHundredRandomReachesAndTheGoalReached) {
  constexpr int kDraws = 200;
  RandomEngine engine = MakeStream(21, 0, "obstacle");
  int kept = 0, reached = 0, met = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Dmp dmp = RandomReach(engine);
    const MotionSamples free = RolloutDmp(dmp, dmp.tau, dmp.tau / 100);
    SphereObstacle obstacle;
    obstacle.radius = Uniform(engine, 0.02, 0.05);
    // Somewhere on or near the way, not at its ends.
    const auto row = static_cast<Eigen::Index>(Uniform(engine, 30, 60));
    obstacle.centre = free.x.row(row).transpose() +
                      0.03 * Vector3d(Normal(engine), Normal(engine), Normal(engine));
    const double room =
        std::min(ObstacleDistance(obstacle, dmp.x0), ObstacleDistance(obstacle, dmp.g));
    if (room < 0.01) {
      --draw;
      continue;
    }
    for (Eigen::Index i = 0; i < free.size(); ++i) {
      if (ObstacleDistance(obstacle, free.x.row(i).transpose()) < 0) {
        ++met;
        break;
      }
    }
    DmpCoupling coupling;
    coupling.obstacles = {obstacle};
    DmpState state = StartDmp(dmp);
    double least = 1;
    for (int i = 0; i < 200; ++i) {
      StepDmp(dmp, 0.01 * dmp.tau, state, coupling);
      least = std::min(least, ObstacleDistance(obstacle, state.x));
    }
    kept += least > -1e-6;
    reached += (state.x - dmp.g).norm() < 0.005;
  }
  EXPECT_GT(met, kDraws / 2);  // without the term most reaches run into it
  EXPECT_EQ(kept, kDraws);
  EXPECT_EQ(reached, kDraws);
}

TEST(DmpObstacle, FarAwayNothingChanges) {
  RandomEngine engine = MakeStream(22, 0, "obstacle");
  const Dmp dmp = RandomReach(engine);
  DmpCoupling coupling;
  SphereObstacle obstacle;
  obstacle.centre = Vector3d(0, 0, 2);
  coupling.obstacles = {obstacle};
  DmpState with = StartDmp(dmp), without = StartDmp(dmp);
  for (int i = 0; i < 150; ++i) {
    StepDmp(dmp, 0.01 * dmp.tau, with, coupling);
    StepDmp(dmp, 0.01 * dmp.tau, without);
  }
  EXPECT_LT((with.x - without.x).norm(), 1e-9);
}

TEST(DmpObstacle, AHeadOnReachGoesAround) {
  Dmp dmp = MakeDmp(Vector3d(-0.3, 0, 0), Vector3d(0.2, 0, 0));
  SphereObstacle obstacle;
  obstacle.centre = Vector3d(0, 0, 0);
  DmpCoupling coupling;
  coupling.obstacles = {obstacle};
  DmpState state = StartDmp(dmp);
  double least = 1;
  for (int i = 0; i < 250; ++i) {
    StepDmp(dmp, 0.01, state, coupling);
    least = std::min(least, ObstacleDistance(obstacle, state.x));
  }
  EXPECT_GT(least, -1e-6);
  EXPECT_LT((state.x - dmp.g).norm(), 0.005);
}

}  // namespace
}  // namespace springgrasp
