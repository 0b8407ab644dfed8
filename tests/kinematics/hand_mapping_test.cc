#include "kinematics/hand_mapping.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "kinematics/hand_ik.h"
#include "real_models.h"

namespace springgrasp {
namespace {

Eigen::VectorXd HumanPosture(const HumanHand& hand, double closing, RandomEngine* engine) {
  Eigen::VectorXd q = hand.rest;
  for (int f = 0; f < kNumFingers; ++f) {
    const std::vector<int>& j = hand.joints[f];
    for (std::size_t i = 0; i < j.size(); ++i) {
      const bool abduction = f != kThumb && i + 4 == j.size();
      const double noise = engine == nullptr ? 0 : 0.2 * Normal(*engine);
      const double low = hand.tree.lower[j[i]], high = hand.tree.upper[j[i]];
      q[j[i]] =
          std::clamp(abduction ? 0.3 * noise : low + closing * (high - low) + noise, low, high);
    }
  }
  return q;
}

TEST(HandMappingTest, StaysWithinTheJointRangesWhateverIsAsked) {
  const RobotHand& robot = TestRobotHand();
  RandomEngine engine = MakeStream(1, 0, "mapping");
  for (int trial = 0; trial < 100; ++trial) {
    MappingTarget target = TargetFromHuman(
        TestHumanHand(), HumanPosture(TestHumanHand(), Uniform01(engine), &engine), robot);
    for (int f = 0; f < kNumFingers; ++f) {
      target.p_HF[f] += 0.05 * Eigen::Vector3d(Normal(engine), Normal(engine), Normal(engine));
      target.lambda[f] = std::pow(10, Uniform(engine, 0, 3));
    }
    const MappingResult result = MapHand(robot, target);
    EXPECT_TRUE((result.q.array() >= robot.tree.lower.array()).all());
    EXPECT_TRUE((result.q.array() <= robot.tree.upper.array()).all());
  }
}

TEST(HandMappingTest, TheOpenHumanHandIsTheOpenRobotHand) {
  const HumanHand& human = TestHumanHand();
  Eigen::VectorXd q = Eigen::VectorXd::Zero(human.tree.num_joints());
  q[human.joints[kThumb][0]] = std::numbers::pi / 2;   // opposed
  q[human.joints[kThumb][1]] = -std::numbers::pi / 4;  // extended
  const RobotHand& robot = TestRobotHand();
  const MappingResult result = MapHand(robot, TargetFromHuman(human, q, robot));
  EXPECT_LT((result.q - robot.open).cwiseAbs().maxCoeff(), 0.1) << result.q.transpose();
}

// A lateral human thumb lies beside the index, which only the hand with the joint can follow.
TEST(HandMappingTest, AThumbThatTurnsFollowsTheHumanOpposition) {
  const HumanHand& human = TestHumanHand();
  const RobotHand& robot = TestOppositionHand();
  ASSERT_EQ(robot.opposition, 11);
  EXPECT_EQ(robot.valves[1], std::vector<int>{11});
  EXPECT_EQ(robot.valves[2], (std::vector<int>{1, 2}));
  EXPECT_EQ(TestRobotHand().opposition, -1);
  Eigen::VectorXd q = human.rest;
  double last = 10;
  for (const double opposition : {0.3, 0.9, 1.5}) {
    q[human.joints[kThumb][0]] = opposition;
    const MappingTarget target = TargetFromHuman(human, q, robot);
    EXPECT_NEAR(target.opposition, std::numbers::pi / 2 - opposition, 1e-12);
    const MappingResult result = MapHand(robot, target);
    EXPECT_LT(result.q[robot.opposition], last);
    last = result.q[robot.opposition];
    EXPECT_NEAR(last, target.opposition, 0.5);
  }
}

TEST(HandMappingTest, JointsOfOneValveBendAlike) {
  RandomEngine engine = MakeStream(5, 0, "mapping");
  for (const RobotHand* robot : {&TestRobotHand(), &TestOppositionHand()}) {
    for (int trial = 0; trial < 20; ++trial) {
      const MappingTarget target = TargetFromHuman(
          TestHumanHand(), HumanPosture(TestHumanHand(), Uniform01(engine), &engine), *robot);
      const Eigen::VectorXd q = MapHand(*robot, target).q;
      for (const std::vector<int>& valve : robot->valves) {
        for (const int joint : valve) EXPECT_DOUBLE_EQ(q[joint], q[valve.front()]);
      }
    }
  }
}

TEST(HandMappingTest, TheSamePostureOfAnyHandLengthIsTheSameTarget) {
  const RobotHand& robot = TestRobotHand();
  const HumanHand& common = TestHumanHand();
  RandomEngine engine = MakeStream(1, 0, "scaled");
  for (const double factor : {0.8, 1.1}) {
    const HumanHand other = ScaledHand(common, factor);
    const Eigen::VectorXd q = HumanPosture(common, 0.4, &engine);
    std::vector<Pose> X_common, X_other;
    ForwardKinematics(common.tree, q, X_common);
    ForwardKinematics(other.tree, q, X_other);
    const MappingTarget a = TargetFromHuman(common, q, robot), b = TargetFromHuman(other, q, robot);
    for (int f = 0; f < kNumFingers; ++f) {
      EXPECT_LT((FramePose(other.tree, X_other, other.tip[f]).translation() -
                 factor * FramePose(common.tree, X_common, common.tip[f]).translation())
                    .norm(),
                1e-12);
      EXPECT_LT((a.p_HF[f] - b.p_HF[f]).norm(), 1e-12) << kFingerNames[f];
      EXPECT_EQ(a.sigma[f], b.sigma[f]);
    }
  }
}

TEST(HandMappingTest, ClosingTheHumanHandClosesEveryRobotFinger) {
  const RobotHand& robot = TestRobotHand();
  Eigen::VectorXd previous;
  for (double closing = 0.1; closing < 0.55; closing += 0.05) {
    const MappingTarget target =
        TargetFromHuman(TestHumanHand(), HumanPosture(TestHumanHand(), closing, nullptr), robot);
    const Eigen::VectorXd q = MapHand(robot, target, previous).q;
    if (previous.size() > 0) {
      for (const RobotHand::Finger& finger : robot.fingers) {
        EXPECT_GT(q[finger.j0] + q[finger.j1], previous[finger.j0] + previous[finger.j1]);
      }
    }
    previous = q;
  }
}

TEST(HandMappingTest, IsAsGoodAsManyStartsOfNlopt) {
  const RobotHand& robot = TestRobotHand();
  RandomEngine engine = MakeStream(2, 0, "mapping");
  int worse = 0;
  for (int trial = 0; trial < 60; ++trial) {
    MappingTarget target = TargetFromHuman(
        TestHumanHand(), HumanPosture(TestHumanHand(), Uniform01(engine), &engine), robot);
    for (double& lambda : target.lambda) lambda = std::pow(10, trial % 4);
    const double found = MapHand(robot, target).cost;
    const double best = MapHandByNlopt(robot, target, 20).cost;
    if (found > best + 1e-9 + 1e-6 * best) ++worse;
  }
  EXPECT_LE(worse, 0);
}

TEST(HandMappingTest, MoreWeightOnTheTipsBringsThemNearer) {
  const RobotHand& robot = TestRobotHand();
  RandomEngine engine = MakeStream(3, 0, "mapping");
  double mean[2] = {0, 0};
  for (int trial = 0; trial < 40; ++trial) {
    // Tips that the robot can reach: of a robot posture, with the joints of another.
    MappingTarget target;
    target.p_HF = TipPositions(robot, RandomPosture(robot.tree, engine));
    const Eigen::VectorXd other = RandomPosture(robot.tree, engine);
    for (int f = 0; f < kNumFingers; ++f) {
      target.sigma[f] = {other[robot.fingers[f].j0], other[robot.fingers[f].j1]};
    }
    for (int i = 0; i < 2; ++i) {
      target.lambda.fill(i == 0 ? 1 : 1000);
      const MappingResult result = MapHand(robot, target);
      for (const double e : result.tip_error) mean[i] += e / (40 * kNumFingers);
    }
  }
  EXPECT_LT(mean[1], 0.5 * mean[0]);
}

TEST(HandMappingTest, AContinuousMotionMapsToAContinuousMotion) {
  const RobotHand& robot = TestRobotHand();
  RandomEngine engine = MakeStream(4, 0, "mapping");
  const Eigen::VectorXd from = HumanPosture(TestHumanHand(), 0.1, &engine);
  const Eigen::VectorXd to = HumanPosture(TestHumanHand(), 0.6, &engine);
  Eigen::VectorXd previous;
  for (int i = 0; i <= 200; ++i) {
    MappingTarget target = TargetFromHuman(TestHumanHand(), from + i / 200.0 * (to - from), robot);
    target.lambda.fill(std::pow(10, 3 * i / 200.0));
    const Eigen::VectorXd q = MapHand(robot, target, previous).q;
    if (previous.size() > 0) {
      EXPECT_LT((q - previous).cwiseAbs().maxCoeff(), 3 * std::numbers::pi / 180) << i;
    }
    previous = q;
  }
}

// A straight middle finger whose tip is wanted nearer and nearer to the knuckle is best bent at its
// middle joint in the end, where following the frame before never comes to.
TEST(HandMappingTest, BehindTheContactTheBetterBendIsTaken) {
  const RobotHand& robot = TestRobotHand();
  const RobotHand::Finger& middle = robot.fingers[kMiddle];
  constexpr int kFrames = 150;
  MappingOptions options;
  options.max_step = 3 * std::numbers::pi / 180;
  const auto tip = [&](double j0, double j1) {
    Eigen::VectorXd q = robot.open;
    q[middle.j0] = j0;
    q[middle.j1] = j1;
    return TipPositions(robot, q)[kMiddle];
  };
  std::vector<MappingTarget> targets;
  for (int k = 0; k < kFrames; ++k) {
    MappingTarget target;
    target.lambda.fill(1);
    target.lambda[kMiddle] = 1000;
    target.sigma.fill(Eigen::Vector2d::Zero());
    target.p_HF = TipPositions(robot, robot.open);
    const double part = std::min(1.0, k / 100.0);
    target.p_HF[kMiddle] = (1 - part) * tip(0.15, 0) + part * tip(0, 1.4);
    targets.push_back(target);
  }
  const std::vector<MappingResult> along = MapHandAlong(robot, targets, 0, options);
  Eigen::VectorXd followed = along[0].q;
  for (int k = 1; k < kFrames; ++k) {
    followed = MapHand(robot, targets[k], followed, options).q;
    EXPECT_LE((along[k].q - along[k - 1].q).cwiseAbs().maxCoeff(), options.max_step * (1 + 1e-9));
  }
  const double best = MapHandByNlopt(robot, targets.back(), 20).cost;
  EXPECT_GT(MapHand(robot, targets.back(), followed, options).cost, 1.1 * best);
  EXPECT_LT(along.back().cost, best + 1e-9 + 1e-6 * best);
}

}  // namespace
}  // namespace springgrasp
