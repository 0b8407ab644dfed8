#include "experiment/grasp_quality.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

std::vector<QualityContact> Opposed(double friction, double torsion) {
  QualityContact a, b;
  a.p = Eigen::Vector3d(-0.02, 0, 0);
  a.n = Eigen::Vector3d::UnitX();
  b.p = Eigen::Vector3d(0.02, 0, 0);
  b.n = -Eigen::Vector3d::UnitX();
  a.friction = b.friction = friction;
  a.torsion = b.torsion = torsion;
  return {a, b};
}

TEST(GraspQualityTest, TwoOpposedSoftFingersClose) {
  const GraspQuality6d q = EvaluateGraspQuality(Opposed(0.9, 0.005), 0.02);
  EXPECT_GT(q.epsilon, 1e-3);
  EXPECT_GT(q.volume, 0);
}

TEST(GraspQualityTest, TwoHardFingersDoNotClose) {
  // Without torsion nothing resists a turn about the line between them.
  EXPECT_LE(EvaluateGraspQuality(Opposed(0.9, 0), 0.02).epsilon, 1e-9);
}

TEST(GraspQualityTest, FingersOnTheSameSideDoNotClose) {
  std::vector<QualityContact> contacts = Opposed(0.9, 0.005);
  contacts[1].p = Eigen::Vector3d(-0.02, 0.01, 0);
  contacts[1].n = Eigen::Vector3d::UnitX();
  EXPECT_LE(EvaluateGraspQuality(contacts, 0.02).epsilon, 1e-9);
}

TEST(GraspQualityTest, MoreFrictionIsNeverWorse) {
  double last = 0;
  for (const double friction : {0.2, 0.4, 0.8, 1.2}) {
    const double epsilon = EvaluateGraspQuality(Opposed(friction, 0.005), 0.02).epsilon;
    EXPECT_GE(epsilon, last - 1e-12);
    last = epsilon;
  }
}

TEST(GraspQualityTest, ATaskIsWithstoodByFrictionAcrossTheLineAndByNothingBesideIt) {
  Eigen::Matrix<double, 6, 1> weight = Eigen::Matrix<double, 6, 1>::Zero();
  weight[2] = -1;
  for (const double friction : {0.3, 0.9}) {
    EXPECT_NEAR(EvaluateGraspQuality(Opposed(friction, 0.005), 0.02, {weight}).task, friction,
                1e-9);
  }
  std::vector<QualityContact> same_side = Opposed(0.9, 0.005);
  same_side[1].p = Eigen::Vector3d(-0.02, 0.01, 0);
  same_side[1].n = Eigen::Vector3d::UnitX();
  EXPECT_LE(EvaluateGraspQuality(same_side, 0.02, {weight}).task, 0);
}

TEST(GraspQualityTest, TheWorstOfTheTasksCounts) {
  Eigen::Matrix<double, 6, 1> weight = Eigen::Matrix<double, 6, 1>::Zero(), turn = weight;
  weight[2] = -1;
  turn[3] = 1;  // about the line between the fingers: torsion alone withstands it
  const std::vector<QualityContact> contacts = Opposed(0.9, 0.005);
  EXPECT_NEAR(EvaluateGraspQuality(contacts, 0.02, {weight, turn}).task,
              EvaluateGraspQuality(contacts, 0.02, {turn}).task, 1e-12);
  EXPECT_NEAR(EvaluateGraspQuality(contacts, 0.02, {turn}).task, 0.005 / 0.02, 1e-9);
}

TEST(GraspQualityTest, OneContactDoesNotClose) {
  EXPECT_EQ(EvaluateGraspQuality({QualityContact()}, 0.02).epsilon, 0);
}

}  // namespace
}  // namespace springgrasp
