#include "kinematics/arm_swivel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinematics/arm_choice.h"
#include "kinematics/swivel_path.h"
#include "motion/minimum_jerk.h"
#include "test_arm.h"

namespace springgrasp {
namespace {

Eigen::VectorXd AnyPosture(const ArmGeometry& g, RandomEngine& engine, double part = 1) {
  Eigen::VectorXd q(7);
  for (int i = 0; i < 7; ++i) {
    const double middle = 0.5 * (g.lower[i] + g.upper[i]);
    q[i] = middle + part * (Uniform(engine, g.lower[i], g.upper[i]) - middle);
  }
  return q;
}

double Off(const Pose& a, const Pose& b) {
  return std::max((a.translation() - b.translation()).norm(),
                  (a.linear() - b.linear()).cwiseAbs().maxCoeff());
}

TEST(ArmSwivelTest, BothArmsHaveTheClosedForm) {
  EXPECT_TRUE(GeometryOf(TestArm()).has_value());
  const auto model = LoadModel("armar3b/armar3b.xml");
  const KinematicTree tree = KinematicTreeOf(*model, "world", {"hand_l_H"});
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(tree.num_joints());
  EXPECT_TRUE(GeometryOf(MakeArm(tree, "hand_l_H", "arm_l_", zero)).has_value());
  EXPECT_FALSE(GeometryOf(MakeArm(tree, "hand_l_H", "arm_l_", zero, true)).has_value());
}

TEST(ArmSwivelTest, EveryPostureIsAmongTheSolutionsOfItsPose) {
  const ArmGeometry g = *GeometryOf(TestArm());
  ArmSolutions solutions;
  RandomEngine engine = MakeStream(1, 0, "swivel");
  for (int n = 0; n < 500; ++n) {
    const Eigen::VectorXd q = AnyPosture(g, engine);
    solutions.Solve(g, HandPose(TestArm(), q));
    const auto found = solutions.SwivelOf(q);
    ASSERT_TRUE(found);
    EXPECT_LT((solutions.JointsAt(found->first, found->second) - q).cwiseAbs().maxCoeff(), 1e-6);
    const bool inside = std::any_of(
        solutions.intervals().begin(), solutions.intervals().end(), [&](const SwivelInterval& i) {
          const double turn = 2 * M_PI;
          const double s = i.from + std::fmod(std::fmod(found->second - i.from, turn) + turn, turn);
          return i.SameBranch(found->first) && s <= i.to + 1e-9;
        });
    EXPECT_TRUE(inside) << q.transpose();
  }
}

TEST(ArmSwivelTest, EverySwivelOfAnIntervalHasThePoseWithinTheRangesAndNoneBeyond) {
  const ArmGeometry g = *GeometryOf(TestArm());
  ArmSolutions solutions;
  RandomEngine engine = MakeStream(2, 0, "swivel");
  const auto within = [&](const SevenJoints& q) {
    return (q.array() >= g.lower.array() - 1e-9).all() &&
           (q.array() <= g.upper.array() + 1e-9).all();
  };
  for (int n = 0; n < 200; ++n) {
    const Pose X_WH = HandPose(TestArm(), AnyPosture(g, engine));
    solutions.Solve(g, X_WH);
    ASSERT_FALSE(solutions.intervals().empty());
    for (const SwivelInterval& interval : solutions.intervals()) {
      for (const double part : {0.0, 0.3, 0.7, 1.0}) {
        const SevenJoints q =
            solutions.JointsAt(interval, interval.from + part * (interval.to - interval.from));
        EXPECT_LT(Off(HandPose(TestArm(), q), X_WH), 1e-6);
        EXPECT_TRUE(within(q)) << q.transpose();
      }
      if (interval.to - interval.from > 6) continue;
      EXPECT_FALSE(within(solutions.JointsAt(interval, interval.from - 1e-4)) &&
                   within(solutions.JointsAt(interval, interval.to + 1e-4)));
    }
  }
}

TEST(ArmSwivelTest, AMarginShrinksTheIntervals) {
  const ArmGeometry g = *GeometryOf(TestArm());
  RandomEngine engine = MakeStream(3, 0, "swivel");
  const Pose X_WH = HandPose(TestArm(), AnyPosture(g, engine, 0.5));
  const auto length = [&](double margin) {
    ArmSolutions solutions;
    solutions.Solve(g, X_WH, margin);
    double sum = 0;
    for (const SwivelInterval& interval : solutions.intervals()) sum += interval.to - interval.from;
    return sum;
  };
  EXPECT_LT(length(0.1), length(0.0));
}

TEST(ArmChoiceTest, TakesTheLowElbowUnlessAskedToStay) {
  const ArmGeometry g = *GeometryOf(TestArm());
  ArmSolutions solutions;
  RandomEngine engine = MakeStream(4, 0, "swivel");
  double low = 0, as_made = 0;
  for (int n = 0; n < 50; ++n) {
    const Eigen::VectorXd made = AnyPosture(g, engine, 0.9);
    solutions.Solve(g, HandPose(TestArm(), made));
    ArmPreference preference;
    preference.elbow = 5;
    const auto choice = ChoosePosture(g, solutions, preference);
    ASSERT_TRUE(choice);
    low += solutions.ElbowHeight(choice->branch, choice->swivel);
    const auto found = solutions.SwivelOf(made);
    as_made += solutions.ElbowHeight(found->first, found->second);
    preference.step = 1e3;
    preference.near = made;
    EXPECT_LT((ChoosePosture(g, solutions, preference)->q - made).norm(), 0.1);
  }
  EXPECT_LT(low, as_made);
}

// A path that a joint motion makes, planned again from its poses.
TEST(SwivelPathTest, FollowsWhatThePosesOfAJointMotionAsk) {
  const ArmGeometry g = *GeometryOf(TestArm());
  RandomEngine engine = MakeStream(5, 0, "swivel");
  int complete = 0;
  for (int n = 0; n < 10; ++n) {
    const Eigen::VectorXd a = AnyPosture(g, engine, 0.8), b = AnyPosture(g, engine, 0.8);
    SwivelPathRequest request;
    request.dt = 0.01;
    request.start = a;
    for (int k = 0; k < 200; ++k) {
      request.X_WH.push_back(HandPose(TestArm(), a + MinimumJerkPosition(k / 199.0) * (b - a)));
    }
    const ArmPath path = PlanSwivelPath(g, request);
    if (!path.complete) continue;
    ++complete;
    EXPECT_LT((path.q.front() - a).norm(), 1e-9);
    for (std::size_t k = 0; k < path.q.size(); ++k) {
      EXPECT_LT(Off(HandPose(TestArm(), path.q[k]), request.X_WH[k]), 1e-6);
      if (k == 0) continue;
      EXPECT_LT((path.q[k] - path.q[k - 1]).cwiseAbs().maxCoeff(), 0.1);
    }
  }
  EXPECT_GE(complete, 9);
}

TEST(SwivelPathTest, TheElbowGoesAroundAnObstacle) {
  const Arm& arm = TestArm();
  const ArmGeometry g = *GeometryOf(arm);
  SwivelPathRequest request;
  request.dt = 0.01;
  for (int k = 0; k < 150; ++k) {
    Pose X = HandPose(arm, HomePosture(arm));
    X.translation().y() += 0.05 * MinimumJerkPosition(k / 149.0);
    request.X_WH.push_back(X);
  }
  const int elbow = arm.tree.NodeIndex("arm_r_elbow");
  const auto elbow_at = [&](const Eigen::VectorXd& q) {
    Eigen::VectorXd full = arm.q;
    for (int i = 0; i < 7; ++i) full[arm.joints[i]] = q[i];
    std::vector<Pose> X_WB;
    ForwardKinematics(arm.tree, full, X_WB);
    return Eigen::Vector3d(X_WB[elbow].translation());
  };
  const ArmPath free = PlanSwivelPath(g, request);
  ASSERT_TRUE(free.complete) << free.reason;
  const Eigen::Vector3d centre = elbow_at(free.q[75]);
  const double radius = 0.04;
  request.obstacles = [&](const SevenJoints& q, int) {
    return (elbow_at(q) - centre).norm() < radius ? std::numeric_limits<double>::infinity() : 0;
  };
  const ArmPath around = PlanSwivelPath(g, request);
  ASSERT_TRUE(around.complete) << around.reason;
  for (const Eigen::VectorXd& q : around.q) {
    EXPECT_GT((elbow_at(q) - centre).norm(), 0.9 * radius);
  }
}

}  // namespace
}  // namespace springgrasp
