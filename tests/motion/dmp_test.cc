// The reach primitive: reproduction, closed forms, scaling, orientation, coupling.
#include "motion/dmp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

// A curved reach at the given times: minimum jerk along two axes, a bump along the third.
MotionSamples Reach(const VectorXd& t, double T) {
  MotionSamples out;
  out.t = t;
  out.x.resize(t.size(), 3);
  out.v = out.a = out.x;
  const auto zero = VectorXd::Zero(3);
  const MinimumJerk line =
      MakeMinimumJerk({Vector3d(0.1, -0.2, 0), zero, zero}, {Vector3d(0.4, 0.1, 0), zero, zero}, T);
  for (Index i = 0; i < t.size(); ++i) {
    const MotionState state = EvaluateMinimumJerk(line, t[i]);
    const double s = t[i] / T;
    out.x.row(i) = state.x.transpose();
    out.v.row(i) = state.v.transpose();
    out.a.row(i) = state.a.transpose();
    // 0.08 * 64 s^3 (1 - s)^3 in z
    const double c = 0.08 * 64;
    out.x(i, 2) = c * std::pow(s * (1 - s), 3);
    out.v(i, 2) = c * 3 * std::pow(s * (1 - s), 2) * (1 - 2 * s) / T;
    out.a(i, 2) =
        c * (6 * s * (1 - s) * std::pow(1 - 2 * s, 2) - 6 * std::pow(s * (1 - s), 2)) / (T * T);
  }
  return out;
}

TEST(Dmp, ReproducesWhatItWasLearnedFrom) {
  const MotionSamples reach = Reach(EvenTimes(1.2, 0.01), 1.2);
  const Dmp dmp = LearnDmp(reach);
  const MotionSamples out = RolloutDmp(dmp, reach.t);
  EXPECT_LT((out.x - reach.x).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT((out.a - reach.a).norm(), 0.1 * reach.a.norm());
}

TEST(Dmp, UnevenSamplesWithAGapGiveNearlyTheSamePath) {
  RandomEngine engine = MakeStream(1, 0, "uneven");
  std::vector<double> times;
  for (double t = 0; t < 1.2; t += Uniform(engine, 0.005, 0.05)) {
    if (t < 0.5 || t > 0.6) times.push_back(t);
  }
  times.push_back(1.2);
  const VectorXd t = Eigen::Map<const VectorXd>(times.data(), static_cast<Index>(times.size()));
  const MotionSamples reach = Reach(EvenTimes(1.2, 0.01), 1.2);
  const MotionSamples out = RolloutDmp(LearnDmp(Reach(t, 1.2)), reach.t);
  EXPECT_LT((out.x - reach.x).cwiseAbs().maxCoeff(), 3e-3);
}

TEST(Dmp, GoalAndStartChangesFollowTheClosedForm) {
  const Dmp dmp = LearnDmp(Reach(EvenTimes(1.2, 0.01), 1.2));
  const VectorXd t = EvenTimes(1.8, 0.05);
  const MatrixXd x = RolloutDmp(dmp, t).x;
  const Vector3d shift(0.05, -0.03, 0.1);
  Dmp moved = dmp;
  moved.g += shift;
  const MatrixXd x_goal = RolloutDmp(moved, t).x;
  moved = dmp;
  moved.x0 += shift;
  const MatrixXd x_start = RolloutDmp(moved, t).x;
  for (Index i = 0; i < t.size(); ++i) {
    const double B = DmpGoalResponse(dmp, t[i]);
    EXPECT_LT((x_goal.row(i) - x.row(i) - B * shift.transpose()).norm(), 1e-10);
    EXPECT_LT((x_start.row(i) - x.row(i) - (1 - B) * shift.transpose()).norm(), 1e-10);
  }
  // The note's figures for a moved goal at tau and 1.5 tau.
  EXPECT_NEAR(1 - DmpGoalResponse(dmp, 1.2), 0.026, 0.001);
  EXPECT_NEAR(1 - DmpGoalResponse(dmp, 1.8), 0.0026, 0.0002);
}

TEST(Dmp, TimeScalingKeepsThePath) {
  const Dmp dmp = LearnDmp(Reach(EvenTimes(1.2, 0.01), 1.2));
  Dmp slow = dmp;
  slow.tau = 2.5 * dmp.tau;
  const VectorXd t = EvenTimes(1.8, 0.1);
  const Vector3d v0(0.1, 0, -0.2);
  const MotionSamples fast = RolloutDmp(dmp, t, v0);
  const MotionSamples stretched = RolloutDmp(slow, 2.5 * t, v0 / 2.5);
  EXPECT_LT((fast.x - stretched.x).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((fast.v - 2.5 * stretched.v).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((fast.a - 6.25 * stretched.a).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Dmp, ResultsDoNotDependOnTheTimesAskedFor) {
  const Dmp dmp = LearnDmp(Reach(EvenTimes(1.2, 0.01), 1.2));
  const MotionSamples coarse = RolloutDmp(dmp, EvenTimes(1.8, 0.3));
  const MotionSamples fine = RolloutDmp(dmp, EvenTimes(1.8, 0.0001));
  for (Index i = 0; i < coarse.size(); ++i) {
    EXPECT_LT((coarse.x.row(i) - fine.x.row(3000 * i)).norm(), 1e-10);
    EXPECT_LT((coarse.a.row(i) - fine.a.row(3000 * i)).norm(), 1e-8);
  }
}

TEST(Dmp, ForcingIsFiniteFarFromAllCentres) {
  Dmp dmp = LearnDmp(Reach(EvenTimes(1.2, 0.01), 1.2));
  dmp.widths *= 1e8;
  for (const double s : {1.0, 0.5, 0.03, 1e-4, 0.0}) EXPECT_TRUE(DmpForcing(dmp, s).allFinite());
}

TEST(Dmp, SteppingEqualsTheRolloutAndPhaseStoppingKeepsThePath) {
  const Dmp dmp = LearnDmp(Reach(EvenTimes(1.2, 0.01), 1.2));
  const MotionSamples rollout = RolloutDmp(dmp, 1.2, 0.01);
  DmpState state = StartDmp(dmp);
  for (Index i = 1; i < rollout.size(); ++i) {
    StepDmp(dmp, 0.01, state);
    ASSERT_LT((state.x.transpose() - rollout.x.row(i)).norm(), 1e-11);
  }
  // The robot is stuck at the start: the plan slows down but stays on its path.
  DmpCoupling coupling;
  coupling.phase_stopping = 1e3;
  coupling.measured = dmp.x0;
  state = StartDmp(dmp);
  for (int i = 0; i < 120; ++i) StepDmp(dmp, 0.01, state, coupling);
  EXPECT_GT(state.s, 0.02);
  const double t = -std::log(state.s) * dmp.tau / dmp.alpha;
  const MotionSamples on_path = RolloutDmp(dmp, Eigen::Vector2d(0, t));
  EXPECT_LT((state.x.transpose() - on_path.x.row(1)).norm(), 1e-9);
}

TEST(Dmp, ACouplingTermPushesThePathAside) {
  const Dmp dmp = LearnDmp(Reach(EvenTimes(1.2, 0.01), 1.2));
  DmpCoupling coupling;
  coupling.acceleration = [](const VectorXd&, const VectorXd&) { return Vector3d(0, 0, 1.0); };
  DmpState state = StartDmp(dmp);
  for (int i = 0; i < 360; ++i) StepDmp(dmp, 0.01, state, coupling);
  // At rest the push equals K/tau^2 times the deviation.
  EXPECT_NEAR(state.x.z() - dmp.g.z(), 1.2 * 1.2 / dmp.K, 1e-4);
}

TEST(Dmp, UnusableInputIsRefused) {
  MotionSamples reach = Reach(EvenTimes(1.2, 0.1), 1.2);
  reach.t[3] = reach.t[2];
  EXPECT_THROW(LearnDmp(reach), Error);
  reach = Reach(EvenTimes(1.2, 0.1), 1.2);
  reach.x(2, 1) = std::nan("");
  EXPECT_THROW(LearnDmp(reach), Error);
  EXPECT_THROW(LearnDmp(Reach(EvenTimes(1.2, 0.6), 1.2)), Error);
}

std::vector<Pose> PoseReach(const VectorXd& t, double T) {
  const MotionSamples reach = Reach(t, T);
  std::vector<Pose> out;
  for (Index i = 0; i < t.size(); ++i) {
    const double s = MinimumJerkPosition(t[i] / T);
    const Quaterniond R = ExpRotation(Vector3d(0.3, -0.2, 0.5)) *
                          ExpRotation(Vector3d(1.5 * s, 0.8 * s * s, -0.4 * s));
    out.push_back(MakePose(reach.x.row(i).transpose(), R));
  }
  return out;
}

TEST(PoseDmp, ReproducesPositionAndOrientationAndEndsAtTheGoal) {
  const VectorXd t = EvenTimes(1.2, 0.01);
  const std::vector<Pose> poses = PoseReach(t, 1.2);
  const PoseDmp dmp = LearnPoseDmp(t, poses);
  const PoseMotion out = RolloutPoseDmp(dmp, t);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((out.X_WB[i].translation() - poses[i].translation()).norm(), 1e-3);
    EXPECT_LT(RotationDistance(Quaterniond(out.X_WB[i].linear()), Quaterniond(poses[i].linear())),
              0.01);
  }
  EXPECT_LT((GoalPose(dmp).matrix() - poses.back().matrix()).norm(), 1e-9);
  EXPECT_LT((StartPose(dmp).matrix() - poses.front().matrix()).norm(), 1e-9);
}

TEST(PoseDmp, MovingStartAndGoalTogetherMovesTheWholeReach) {
  const VectorXd t = EvenTimes(1.2, 0.02);
  const PoseDmp dmp = LearnPoseDmp(t, PoseReach(t, 1.2));
  const PoseMotion before = RolloutPoseDmp(dmp, t);
  // Rotations carry through; positions by translation (the forcing does not turn with the goal).
  const Quaterniond Q = ExpRotation(Vector3d(-0.4, 1.1, 0.6));
  Pose start = StartPose(dmp), goal = GoalPose(dmp);
  for (Pose* X : {&start, &goal}) {
    X->linear() = (Q * Quaterniond(X->linear())).toRotationMatrix();
    X->translation() += Vector3d(0.2, 0.3, -0.1);
  }
  const PoseMotion after = RolloutPoseDmp(WithEndpoints(dmp, start, goal), t);
  for (std::size_t i = 0; i < before.X_WB.size(); ++i) {
    EXPECT_LT(RotationDistance(Quaterniond(after.X_WB[i].linear()),
                               Q * Quaterniond(before.X_WB[i].linear())),
              1e-7);
    EXPECT_LT(
        (after.X_WB[i].translation() - before.X_WB[i].translation() - Vector3d(0.2, 0.3, -0.1))
            .norm(),
        1e-9);
  }
}

TEST(PoseDmp, ReachesAnotherGoalOrientation) {
  const VectorXd t = EvenTimes(1.2, 0.02);
  const PoseDmp dmp = LearnPoseDmp(t, PoseReach(t, 1.2));
  Pose goal = GoalPose(dmp);
  goal.linear() =
      (ExpRotation(Vector3d(0, 0, 0.5)) * Quaterniond(goal.linear())).toRotationMatrix();
  goal.translation() += Vector3d(0.1, 0, 0);
  const PoseMotion out =
      RolloutPoseDmp(WithEndpoints(dmp, StartPose(dmp), goal), EvenTimes(3.0, 0.1));
  EXPECT_LT(RotationDistance(Quaterniond(out.X_WB.back().linear()), Quaterniond(goal.linear())),
            1e-3);
  EXPECT_LT((out.X_WB.front().matrix() - StartPose(dmp).matrix()).norm(), 1e-9);
}

TEST(PoseDmp, VelocitiesAreThoseOfThePoses) {
  const VectorXd t = EvenTimes(1.2, 0.001);
  const PoseDmp dmp = LearnPoseDmp(t, PoseReach(t, 1.2));
  VectorXd v0(6);
  v0 << 0.1, 0.2, -0.1, 0.3, -0.5, 0.4;
  const PoseMotion out = RolloutPoseDmp(dmp, t, v0);
  EXPECT_LT((out.velocity.row(0).transpose() - v0).norm(), 1e-9);
  for (Index i = 100; i < t.size() - 1; i += 100) {
    const auto& before = out.X_WB[static_cast<std::size_t>(i - 1)];
    const auto& after = out.X_WB[static_cast<std::size_t>(i + 1)];
    const Vector3d omega =
        LogRotation(Quaterniond(after.linear()) * Quaterniond(before.linear()).conjugate()) / 0.002;
    EXPECT_LT((out.velocity.row(i).tail<3>().transpose() - omega).norm(), 1e-4);
    const Vector3d v = (after.translation() - before.translation()) / 0.002;
    EXPECT_LT((out.velocity.row(i).head<3>().transpose() - v).norm(), 1e-4);
  }
}

TEST(PoseDmp, CoordinatesAreContinuousThroughHalfATurn) {
  std::vector<Pose> poses;
  for (int i = 0; i <= 100; ++i) {
    poses.push_back(MakePose(Vector3d::Zero(), ExpRotation(Vector3d(0, 0, 0.04 * i))));
  }
  const MatrixXd x = PoseCoordinates(poses, Quaterniond::Identity());
  for (Index i = 0; i < x.rows(); ++i) {
    EXPECT_NEAR(x(i, 5), 0.04 * static_cast<double>(i), 1e-9);
  }
}

}  // namespace
}  // namespace springgrasp
