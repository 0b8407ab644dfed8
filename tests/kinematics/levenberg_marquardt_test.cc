#include "kinematics/levenberg_marquardt.h"

#include <gmock/gmock.h>

#include <cmath>

#include "base/random.h"
#include "kinematics/kinematic_tree.h"

namespace springgrasp {
namespace {

// Rosenbrock's valley as least squares: minimum 0 at (1, 1).
LeastSquaresProblem Valley(double lower, double upper) {
  LeastSquaresProblem problem;
  problem.num_residuals = 2;
  problem.lower = Eigen::Vector2d::Constant(lower);
  problem.upper = Eigen::Vector2d::Constant(upper);
  problem.evaluate = [=](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    EXPECT_TRUE((x.array() >= lower).all() && (x.array() <= upper).all()) << x.transpose();
    r << 10 * (x[1] - x[0] * x[0]), 1 - x[0];
    if (J != nullptr) *J << -20 * x[0], 10, -1, 0;
  };
  return problem;
}

TEST(LevenbergMarquardtTest, FindsTheEndOfAValley) {
  const auto result = MinimizeLeastSquares(Valley(-5, 5), Eigen::Vector2d(-1.2, 1));
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.x[0], 1, 1e-8);
  EXPECT_NEAR(result.x[1], 1, 1e-8);
}

TEST(LevenbergMarquardtTest, StopsAtTheBoundWhereTheMinimumLiesBeyond) {
  // With x0 <= 0.5 the best is x = (0.5, 0.25).
  const auto result = MinimizeLeastSquares(Valley(-5, 0.5), Eigen::Vector2d(-1.2, 0.4));
  EXPECT_DOUBLE_EQ(result.x[0], 0.5);
  EXPECT_NEAR(result.x[1], 0.25, 1e-8);
  EXPECT_NEAR(result.cost, 0.125, 1e-10);
}

TEST(LevenbergMarquardtTest, ClampsAStartOutsideTheBounds) {
  const auto result = MinimizeLeastSquares(Valley(-2, 2), Eigen::Vector2d(100, -100));
  EXPECT_NEAR(result.x[0], 1, 1e-6);
}

TEST(LevenbergMarquardtTest, BoundedLinearFitMeetsTheOptimalityConditions) {
  RandomEngine engine = MakeStream(1, 0, "linear");
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::MatrixXd A(8, 4);
    Eigen::VectorXd b(8);
    for (int i = 0; i < A.size(); ++i) A.data()[i] = Normal(engine);
    for (int i = 0; i < b.size(); ++i) b[i] = 3 * Normal(engine);
    LeastSquaresProblem problem;
    problem.num_residuals = 8;
    problem.lower = Eigen::VectorXd::Constant(4, -0.3);
    problem.upper = Eigen::VectorXd::Constant(4, 0.3);
    problem.evaluate = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
      r = A * x - b;
      if (J != nullptr) *J = A;
    };
    const auto result = MinimizeLeastSquares(problem, Eigen::VectorXd::Zero(4));
    const Eigen::VectorXd gradient = A.transpose() * (A * result.x - b);
    for (int i = 0; i < 4; ++i) {
      if (result.x[i] >= 0.3) {
        EXPECT_LE(gradient[i], 1e-6);
      } else if (result.x[i] <= -0.3) {
        EXPECT_GE(gradient[i], -1e-6);
      } else {
        EXPECT_NEAR(gradient[i], 0, 1e-6);
      }
    }
  }
}

TEST(KinematicTreeTest, JacobianOfHingeAndSlideMatchesDifferences) {
  // A hinge about z, a slide along x, a hinge about y; tip 0.2 m along x.
  KinematicTree tree;
  tree.joint_names = {"turn", "push", "bend"};
  tree.lower = Eigen::Vector3d::Constant(-3);
  tree.upper = Eigen::Vector3d::Constant(3);
  for (int i = 0; i < 3; ++i) {
    KinematicTree::Node node;
    node.name = tree.joint_names[i];
    node.parent = i - 1;
    node.joint = i;
    node.axis = i == 0   ? Eigen::Vector3d::UnitZ()
                : i == 1 ? Eigen::Vector3d::UnitX()
                         : Eigen::Vector3d::UnitY();
    node.slide = i == 1;
    node.X_PB.translation() = Eigen::Vector3d(0.1, 0.02 * i, 0);
    tree.nodes.push_back(node);
  }
  KinematicTree::Frame tip;
  tip.name = "tip";
  tip.node = 2;
  tip.X_BF.translation() = Eigen::Vector3d(0.2, 0, 0.01);
  tree.frames.push_back(tip);
  const Eigen::Vector3d q(0.4, -0.3, 0.7);
  std::vector<Pose> X;
  ForwardKinematics(tree, q, X);
  Eigen::MatrixXd J(6, 3);
  FrameJacobian(tree, X, 0, J);
  const double h = 1e-6;
  for (int j = 0; j < 3; ++j) {
    std::vector<Pose> high, low;
    ForwardKinematics(tree, q + h * Eigen::Vector3d::Unit(j), high);
    ForwardKinematics(tree, q - h * Eigen::Vector3d::Unit(j), low);
    const Pose a = FramePose(tree, high, 0), b = FramePose(tree, low, 0);
    const Eigen::Vector3d v = (a.translation() - b.translation()) / (2 * h);
    const Eigen::Vector3d w =
        LogRotation(Eigen::Quaterniond(a.linear() * b.linear().transpose())) / (2 * h);
    EXPECT_LT((J.col(j).head<3>() - v).norm(), 1e-8);
    EXPECT_LT((J.col(j).tail<3>() - w).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace springgrasp
