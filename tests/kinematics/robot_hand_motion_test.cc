#include <gmock/gmock.h>

#include <numbers>
#include <string>
#include <tuple>

#include "base/error.h"
#include "kinematics/hand_motion.h"
#include "posture_requests.h"

namespace springgrasp {
namespace {

double MinimumJerk(double s) { return s >= 1 ? 1 : s * s * s * (10 + s * (6 * s - 15)); }

struct Case {
  ContactRequest contact;
  ContactPosture posture;
  HandMotionRequest motion;
};

// A straight reach of 0.25 m along `from_O`; the human tips open by 25 mm and close on the
// contacts.
Case MakeCase(const std::string& type, const std::string& shape, const Eigen::Vector3d& from_O) {
  Case c;
  c.contact = MakeRequest(type, ParseShape(shape), {0, -1, 0});
  c.posture = SolveContactPosture(TestRobotHand(), c.contact);
  HandMotionRequest& m = c.motion;
  m.shape = c.contact.shape;
  m.involved = c.contact.involved;
  std::vector<Pose> path;
  for (int k = 0; k < 300; ++k) {
    const double s = MinimumJerk(m.dt * k / m.T);
    Pose X_OH = c.posture.X_HO.inverse();
    X_OH.translation() += 0.25 * (1 - s) * from_O.normalized();
    path.push_back(X_OH);
    PerFinger<Eigen::Vector3d> tips;
    for (int f = 0; f < kNumFingers; ++f) {
      const double open = 0.02 * (1 - s) + 0.025 * std::sin(std::numbers::pi * s);
      tips[f] = c.contact.p_OC[f] + open * c.contact.n_OC[f] + 0.25 * (1 - s) * from_O.normalized();
    }
    for (Eigen::Vector3d& tip : tips) tip = X_OH.inverse() * tip;
    m.p_HF.push_back(tips);
    m.q_human.push_back(TestHumanHand().rest);
  }
  const Eigen::VectorXd q_open = OpenedPosture(TestRobotHand(), c.posture, m.shape, m.involved, 1);
  m.X_OH = ClearApproach(TestRobotHand(), m.shape, path, q_open, m.dt, m.T, 0.01);
  return c;
}

class HandMotionTest : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(HandMotionTest, OpensClearOfTheObjectAndEndsOnTheContacts) {
  const auto& [type, shape] = GetParam();
  const RobotHand& robot = TestRobotHand();
  for (const Eigen::Vector3d& from :
       {Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(0, -0.5, 1), Eigen::Vector3d(-0.3, -1, 0.3)}) {
    const Case c = MakeCase(type, shape, from);
    const HandMotionResult result = MapHandMotion(TestHumanHand(), robot, c.motion, c.posture);
    ASSERT_EQ(result.q.size(), c.motion.q_human.size());
    for (std::size_t k = 0; k < result.q.size(); ++k) {
      EXPECT_TRUE((result.q[k].array() >= robot.tree.lower.array()).all());
      EXPECT_TRUE((result.q[k].array() <= robot.tree.upper.array()).all());
      const double left = c.motion.dt * static_cast<double>(k) < c.motion.T ? 10 : 1e-9;
      EXPECT_LT((result.q[k] - c.posture.q).norm(), left) << k;
    }
    EXPECT_LT(result.max_step, 3 * std::numbers::pi / 180);
    // Fingertip grasps have room; a power grasp squeezes in between thumb and fingers.
    EXPECT_GT(result.clearance, type == "power" ? 0.0005 : 0.008) << from.transpose();
  }
}

INSTANTIATE_TEST_SUITE_P(Grasps, HandMotionTest,
                         ::testing::Values(std::make_tuple("pinch", "sphere:0.04"),
                                           std::make_tuple("pinch", "box:0.04x0.05x0.06"),
                                           std::make_tuple("tripod", "cylinder:0.05x0.1"),
                                           std::make_tuple("power", "cylinder:0.05x0.18"),
                                           std::make_tuple("power", "cylinder:0.06x0.18")));

TEST(ClearApproachTest, LeavesAClearPathAloneAndKeepsBothEnds) {
  const Case c = MakeCase("pinch", "sphere:0.04", {0, -1, 0});
  const RobotHand& robot = TestRobotHand();
  const Eigen::VectorXd q_open =
      OpenedPosture(robot, c.posture, c.motion.shape, c.motion.involved, 1);
  // Straight through the object from the far side: must be moved.
  std::vector<Pose> through;
  for (int k = 0; k <= 200; ++k) {
    Pose X = c.posture.X_HO.inverse();
    X.translation() += 0.2 * (1 - MinimumJerk(k / 200.0)) * Eigen::Vector3d(0, 1, 0);
    through.push_back(X);
  }
  const std::vector<Pose> moved =
      ClearApproach(robot, c.motion.shape, through, q_open, 0.005, 1, 0.01);
  EXPECT_LT((moved.front().matrix() - through.front().matrix()).norm(), 1e-9);
  EXPECT_LT((moved.back().matrix() - through.back().matrix()).norm(), 1e-9);
  double most = 0;
  for (std::size_t k = 0; k < moved.size(); ++k) {
    most = std::max(most, (moved[k].translation() - through[k].translation()).norm());
  }
  EXPECT_GT(most, 0.01);
}

TEST(ClearApproachTest, AnObjectThatWouldSlideInAlongTheFingersComesFromAbove) {
  const Case c = MakeCase("power", "cylinder:0.05x0.18", {0, -1, 0});
  const RobotHand& robot = TestRobotHand();
  const Eigen::VectorXd q_open =
      OpenedPosture(robot, c.posture, c.motion.shape, c.motion.involved, 1);
  std::vector<Pose> along;
  const Pose X_OH = c.posture.X_HO.inverse();
  const Eigen::Vector3d fingers = X_OH.linear() * robot.R_HA.col(0);
  for (int k = 0; k <= 200; ++k) {
    Pose X = X_OH;
    X.translation() -= 0.2 * (1 - MinimumJerk(k / 200.0)) * fingers;
    along.push_back(X);
  }
  std::vector<Pose> X_HB;
  ForwardKinematics(robot.tree, q_open, X_HB);
  const auto least = [&](const std::vector<Pose>& path) {
    double distance = 1;
    for (int k = 0; k < 180; ++k) {
      distance = std::min(distance, HandDistance(robot, X_HB, path[k], c.motion.shape,
                                                 {false, true, true, true, true}, false));
    }
    return distance;
  };
  const std::vector<Pose> moved =
      ClearApproach(robot, c.motion.shape, along, q_open, 0.005, 1, 0.02);
  EXPECT_LT(least(along), 0.003);
  EXPECT_GT(least(moved), 0.005);
  EXPECT_LT((moved.back().matrix() - along.back().matrix()).norm(), 1e-9);
}

TEST(EdgeOnApproachTest, EndsAsThePathAndComesAlongThePlate) {
  const Pose X_HG = MakePose({0.1, 0.02, -0.05}, Eigen::Quaterniond::Identity());
  std::vector<Pose> path;
  for (int k = 0; k <= 300; ++k) {
    const double left = 1 - MinimumJerk(k / 200.0);
    path.push_back(MakePose(left * Eigen::Vector3d(0.2, 0.1, 0.3),
                            Eigen::Quaterniond(Eigen::AngleAxisd(left, Eigen::Vector3d::UnitX()))));
  }
  const Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  const std::vector<Pose> edge_on = EdgeOnApproach(path, X_HG, normal, 0.005, 1);
  ASSERT_EQ(edge_on.size(), path.size());
  EXPECT_LT((edge_on.front().matrix() - path.front().matrix()).norm(), 1e-9);
  for (int k = 200; k <= 300; ++k) {
    EXPECT_LT((edge_on[k].matrix() - path[k].matrix()).norm(), 1e-9) << k;
  }
  const Eigen::Vector3d goal = (path.back() * X_HG).translation();
  double farthest = 0;
  for (int k = 131; k < 200; ++k) {
    const Eigen::Vector3d off = (edge_on[k] * X_HG).translation() - goal;
    EXPECT_LE(off.z(), 1e-9) << k;   // on the fingers' side ...
    EXPECT_GT(off.z(), -0.01) << k;  // ... and near
    farthest = std::max(farthest, off.head<2>().norm());
    EXPECT_LT((edge_on[k].linear() - path.back().linear()).norm(), 1e-9) << k;
  }
  EXPECT_GT(farthest, 0.03);
}

TEST(HandMotionTest, RefusesSeriesOfDifferentLength) {
  Case c = MakeCase("pinch", "sphere:0.04", {0, -1, 0});
  c.motion.p_HF.pop_back();
  EXPECT_THROW(MapHandMotion(TestHumanHand(), TestRobotHand(), c.motion, c.posture), Error);
}

}  // namespace
}  // namespace springgrasp
