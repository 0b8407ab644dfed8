#include "kinematics/mapping_problem.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "real_models.h"

namespace springgrasp {
namespace {

// A hand somewhere in its ranges, and tips that it does not have there.
struct Case {
  MappingTarget target;
  Eigen::VectorXd previous;
  ValveAngles x;
};

Case RandomCase(const RobotHand& robot, RandomEngine& engine) {
  Case c;
  const auto posture = [&] {
    Eigen::VectorXd q(robot.tree.num_joints());
    for (int j = 0; j < q.size(); ++j) {
      q[j] = Uniform(engine, robot.tree.lower[j], robot.tree.upper[j]);
    }
    return q;
  };
  std::vector<Pose> bodies;
  ForwardKinematics(robot.tree, posture(), bodies);
  for (int f = 0; f < kNumFingers; ++f) {
    const KinematicTree::Frame& tip = robot.tree.frames[robot.fingers[f].tip];
    c.target.p_HF[f] = (bodies[tip.node] * tip.X_BF).translation();
    c.target.sigma[f] = Eigen::Vector2d(Uniform(engine, 0, 1.5), Uniform(engine, 0, 1.5));
    c.target.lambda[f] = std::pow(10, Uniform(engine, 0, 3));
  }
  c.previous = posture();
  FastHand hand(robot);
  c.x = MappingProblem(robot, c.target, c.previous, {}, hand).Start();
  return c;
}

class MappingProblemTest : public testing::TestWithParam<const RobotHand* (*)()> {};

TEST_P(MappingProblemTest, DerivativesAreThoseOfTheCost) {
  const RobotHand& robot = *GetParam()();
  RandomEngine engine = MakeStream(1, 0, "mapping problem");
  MappingOptions options;
  options.smoothness = 0.3;
  FastHand hand(robot);
  for (int trial = 0; trial < 20; ++trial) {
    const Case c = RandomCase(robot, engine);
    MappingProblem problem(robot, c.target, c.previous, options, hand);
    problem.Cost(c.x);
    MappingProblem::Derivatives d;
    problem.Differentiate(d);
    EXPECT_TRUE(d.g.isApprox(problem.Gradient(), 1e-12));
    const double scale = d.A.diagonal().cwiseAbs().maxCoeff();
    for (int v = 0; v < problem.num_valves(); ++v) {
      constexpr double kStep = 1e-5;
      ValveAngles up = c.x, down = c.x;
      up[v] += kStep;
      down[v] -= kStep;
      const double cost_up = problem.Cost(up);
      const ValveAngles g_up = problem.Gradient();
      const double cost_down = problem.Cost(down);
      const ValveAngles g_down = problem.Gradient();
      EXPECT_NEAR(d.g[v], (cost_up - cost_down) / (4 * kStep), 1e-7 * scale) << "valve " << v;
      for (int i = v; i < problem.num_valves(); ++i) {
        EXPECT_NEAR(d.A(i, v) + d.B(i, v), (g_up[i] - g_down[i]) / (2 * kStep), 1e-7 * scale)
            << "valves " << i << ", " << v;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Hands, MappingProblemTest,
    testing::Values([]() -> const RobotHand* { return &TestRobotHand(); },
                    []() -> const RobotHand* { return &TestOppositionHand(); }),
    [](const auto& hand) { return hand.index == 0 ? "Documented" : "Opposition"; });

}  // namespace
}  // namespace springgrasp
