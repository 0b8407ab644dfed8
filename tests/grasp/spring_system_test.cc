// The force balance of the fingertips: exact properties of single evaluations.
#include "grasp/spring_system.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "grasp/spring_test_systems.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Variant {
  int dim;
  SpringDamping damping;
  ForceRatio ratio;
  OpeningDirection opening;
  double radius;
  double f;
};

std::vector<Variant> Variants() {
  std::vector<Variant> out;
  for (const int dim : {2, 3}) {
    for (const auto damping :
         {SpringDamping::kAxial, SpringDamping::kVector, SpringDamping::kLiteral}) {
      for (const auto ratio :
           {ForceRatio::kPaper, ForceRatio::kReciprocal, ForceRatio::kBalanced}) {
        for (const auto opening : {OpeningDirection::kSurface, OpeningDirection::kOutward}) {
          for (const double radius : {0.0, 0.03}) {
            for (const double f : {-0.05, 0.08}) {
              out.push_back({dim, damping, ratio, opening, radius, f});
            }
          }
        }
      }
    }
  }
  return out;
}

SpringSystem Make(const Variant& variant, RandomEngine& engine) {
  SpringSystem system = RandomSystem(engine, variant.dim, variant.dim == 2 ? "fan7" : "brace9");
  system.damping = variant.damping;
  system.ratio = variant.ratio;
  system.opening = variant.opening;
  system.rest_radius.setConstant(variant.radius);
  system.bend = RandomPoints(engine, variant.dim, 5, 8.0);
  system.bend.col(2).setZero();
  system.opening_bend = RandomPoints(engine, variant.dim, 5, 8.0);
  system.opening_bend.col(3).setZero();
  return system;
}

template <typename Force>
VectorXd Acceleration(const SpringSystem& system, const MatrixXd& p, const MatrixXd& v,
                      const Force& f) {
  SpringTerms terms;
  EvaluateSprings(system, p, v, f, terms);
  return terms.acc.reshaped();
}

TEST(SpringSystem, AnalyticJacobianAgreesWithCentralDifferences) {
  RandomEngine engine = MakeStream(1, 0, "jacobian");
  std::vector<std::pair<Variant, double>> cases;  // whole, and between two grasps
  for (const Variant& variant : Variants()) {
    for (const double share : {1.0, 0.7}) cases.emplace_back(variant, share);
  }
  for (const auto& [variant, share] : cases) {
    SpringSystem system = Make(variant, engine);
    system.share[0] = share;
    const MatrixXd p = RandomPoints(engine, variant.dim, 5, 0.08);
    const MatrixXd v = RandomPoints(engine, variant.dim, 5, 0.3);
    SpringTerms terms;
    MatrixXd Jp, Jv;
    // Some fingers still open while others close.
    VectorXd f = VectorXd::Constant(5, variant.f);
    f[1] *= -0.5;
    f[4] *= 2;
    EvaluateSprings(system, p, v, f, terms);
    SpringJacobian(system, p, v, terms, Jp, Jv);
    const double h = 1e-7;
    MatrixXd Jp_numeric(Jp.rows(), Jp.cols()), Jv_numeric = Jp_numeric;
    for (Index c = 0; c < Jp.cols(); ++c) {
      MatrixXd up = p, down = p;
      up.reshaped()[c] += h;
      down.reshaped()[c] -= h;
      Jp_numeric.col(c) =
          (Acceleration(system, up, v, f) - Acceleration(system, down, v, f)) / (2 * h);
      up = v;
      down = v;
      up.reshaped()[c] += h;
      down.reshaped()[c] -= h;
      Jv_numeric.col(c) =
          (Acceleration(system, p, up, f) - Acceleration(system, p, down, f)) / (2 * h);
    }
    EXPECT_LT((Jp - Jp_numeric).norm(), 1e-5 * Jp.norm());
    EXPECT_LT((Jv - Jv_numeric).norm(), 1e-5 * Jv.norm());
  }
}

TEST(SpringSystem, RotationAndTranslationCarryThrough) {
  RandomEngine engine = MakeStream(2, 0, "equivariance");
  for (const Variant& variant : Variants()) {
    const SpringSystem system = Make(variant, engine);
    const MatrixXd p = RandomPoints(engine, variant.dim, 5, 0.08);
    const MatrixXd v = RandomPoints(engine, variant.dim, 5, 0.3);
    const double angle = Uniform(engine, -3, 3);
    MatrixXd R = Eigen::Rotation2Dd(angle).toRotationMatrix();
    if (variant.dim == 3) {
      R = Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, -3).normalized()).toRotationMatrix();
    }
    const VectorXd shift = RandomPoints(engine, variant.dim, 1, 1.0);
    SpringSystem moved = system;
    moved.anchors = (R * system.anchors).colwise() + shift;
    moved.normals = R * system.normals;
    moved.bend = R * system.bend;
    moved.opening_bend = R * system.opening_bend;
    const MatrixXd expected =
        R * Acceleration(system, p, v, variant.f).reshaped(variant.dim, 5).matrix();
    const MatrixXd p_moved = (R * p).colwise() + shift;
    const VectorXd found = Acceleration(moved, p_moved, R * v, variant.f);
    EXPECT_LT((found - expected.reshaped()).norm(), 1e-9 * (1 + found.norm()));
  }
}

TEST(SpringSystem, InternalForcesSumToZeroAndAxialOnesHaveNoTorque) {
  RandomEngine engine = MakeStream(3, 0, "internal");
  for (const Variant& variant : Variants()) {
    SpringSystem system = Make(variant, engine);
    system.involved.assign(5, false);
    const MatrixXd p = RandomPoints(engine, variant.dim, 5, 0.08);
    const MatrixXd v = RandomPoints(engine, variant.dim, 5, 0.3);
    SpringTerms terms;
    EvaluateSprings(system, p, v, variant.f, terms);
    const MatrixXd force = terms.acc * system.mass.asDiagonal();
    EXPECT_LT(force.rowwise().sum().norm(), 1e-14);
    if (variant.damping != SpringDamping::kAxial) continue;
    double torque = 0;  // about z
    for (int i = 0; i < 5; ++i) torque += p(0, i) * force(1, i) - p(1, i) * force(0, i);
    EXPECT_NEAR(torque, 0, 1e-15);
  }
}

TEST(SpringSystem, NegativeForceOpensAndPositiveCloses) {
  for (const auto opening : {OpeningDirection::kSurface, OpeningDirection::kOutward}) {
    SpringSystem system = GraspSystem(true);
    system.opening = opening;
    system.normals = system.anchors;
    system.normals.colwise().normalize();
    const MatrixXd p = GraspStart(), zero = MatrixXd::Zero(2, 5);
    SpringTerms none, terms;
    EvaluateSprings(system, p, zero, 0, none);
    for (const double f : {-0.1, 0.1}) {
      EvaluateSprings(system, p, zero, f, terms);
      for (int i = 0; i < 5; ++i) {
        const double outward = (terms.acc - none.acc).col(i).dot(p.col(i) - system.anchors.col(i));
        EXPECT_GT(-f * outward, 0) << "finger " << i;
      }
    }
  }
}

TEST(SpringSystem, OutwardOpensEvenInsideTheContactDistance) {
  SpringSystem system = GraspSystem(true);
  system.normals = system.anchors;
  system.normals.colwise().normalize();
  const MatrixXd p = 0.9 * system.anchors, zero = MatrixXd::Zero(2, 5);
  SpringTerms none, surface, outward;
  EvaluateSprings(system, p, zero, 0, none);
  EvaluateSprings(system, p, zero, -0.1, surface);
  system.opening = OpeningDirection::kOutward;
  EvaluateSprings(system, p, zero, -0.1, outward);
  for (int i = 0; i < 5; ++i) {
    EXPECT_LT((surface.acc - none.acc).col(i).dot(system.normals.col(i)), 0);
    EXPECT_GT((outward.acc - none.acc).col(i).dot(system.normals.col(i)), 0);
  }
}

TEST(SpringSystem, RatioIsOneAtEqualDistancesAndCapped) {
  SpringSystem system = MakeSpringSystem(3, 2, 0.02);
  system.involved.assign(3, true);
  MatrixXd p(2, 3);
  p << -0.05, 0.05, 0.05, 0, 0, 0;
  SpringTerms terms;
  EvaluateSprings(system, p, MatrixXd::Zero(2, 3), 0.1, terms);
  EXPECT_DOUBLE_EQ(terms.R, 1);
  p(0, 0) = -1e-4;
  EvaluateSprings(system, p, MatrixXd::Zero(2, 3), 0.1, terms);
  EXPECT_EQ(terms.R, system.r_max);
  system.involved[0] = false;
  EvaluateSprings(system, p, MatrixXd::Zero(2, 3), 0.1, terms);
  EXPECT_EQ(terms.R, 1);
}

// Of ratio balanced: whatever the distances, all fingers come nearer at the same rate.
TEST(SpringSystem, BalancedForceClosesEveryFingerInProportionToItsDistance) {
  RandomEngine engine = MakeStream(5, 0, "balanced");
  for (int draw = 0; draw < 20; ++draw) {
    SpringSystem system = RandomSystem(engine, 3, "brace9");
    system.ratio = ForceRatio::kBalanced;
    const MatrixXd p = RandomPoints(engine, 3, 5, 0.08), zero = MatrixXd::Zero(3, 5);
    const MatrixXd closing =
        (Acceleration(system, p, zero, 0.1) - Acceleration(system, p, zero, 0.0)).reshaped(3, 5);
    const MatrixXd force = closing * system.mass.asDiagonal();
    const double rate = force.col(0).norm() / (p - system.anchors).col(0).norm();
    for (int i = 0; i < 5; ++i) {
      if (!system.involved[static_cast<std::size_t>(i)]) continue;
      EXPECT_LT((force + rate * (p - system.anchors)).col(i).norm(), 1e-12);
    }
  }
}

// Along the parabola y = x n - x^2 bend, up to terms of third order in x.
TEST(SpringSystem, BentWaysBackFollowTheirArc) {
  RandomEngine engine = MakeStream(6, 0, "bend");
  for (int draw = 0; draw < 20; ++draw) {
    SpringSystem system = RandomSystem(engine, 3, "brace9");
    system.ratio = ForceRatio::kBalanced;
    const Eigen::Vector3d n = RandomPoints(engine, 3, 1, 1).normalized();
    const Eigen::Vector3d other = RandomPoints(engine, 3, 1, 1);
    const Eigen::Vector3d bend = 5 * n.cross(other).normalized();
    system.bend.col(0) = bend;
    for (const double x : {0.01, 0.04}) {
      MatrixXd p = system.anchors;
      p.colwise() += Eigen::Vector3d(0.02, 0, 0);
      p.col(0) = system.anchors.col(0) + x * n - x * x * bend;
      SpringTerms terms;
      EvaluateSprings(system, p, MatrixXd::Zero(3, 5), 0.1, terms);
      const Eigen::Vector3d tangent = (n - 2 * x * bend).normalized();
      EXPECT_LT((terms.direction.col(0).normalized() - tangent).norm(),
                1.1 * std::pow(x * bend.norm(), 3));
    }
  }
}

// On the parabola w = bend / 2 (x - middle)^2 across the chord, as the preshape gives it.
TEST(SpringSystem, BentWaysOutFollowTheirArc) {
  RandomEngine engine = MakeStream(7, 0, "opening bend");
  for (int draw = 0; draw < 20; ++draw) {
    SpringSystem system = RandomSystem(engine, 3, "brace9");
    system.ratio = ForceRatio::kBalanced;
    system.opening = OpeningDirection::kOutward;
    const Eigen::Vector3d chord = RandomPoints(engine, 3, 1, 1).normalized();
    const Eigen::Vector3d other = RandomPoints(engine, 3, 1, 1);
    const Eigen::Vector3d bend = 10 * chord.cross(other).normalized();
    const double middle = Uniform(engine, -0.02, 0.02);
    system.involved[0] = true;
    system.opening_bend.col(0) = bend;
    system.normals.col(0) = chord - middle * bend;
    for (const double x : {-0.02, 0.01, 0.04}) {
      MatrixXd p = system.anchors;
      p.col(0) += x * chord + 0.5 * (x - middle) * (x - middle) * bend;
      SpringTerms terms;
      EvaluateSprings(system, p, MatrixXd::Zero(3, 5), -0.1, terms);
      EXPECT_LT((terms.direction.col(0) - chord - (x - middle) * bend).norm(), 1e-12);
    }
  }
}

TEST(SpringSystem, DegenerateStatesStayFinite) {
  RandomEngine engine = MakeStream(4, 0, "degenerate");
  for (const Variant& variant : Variants()) {
    const SpringSystem system = Make(variant, engine);
    const MatrixXd p = system.anchors.col(0).replicate(1, 5);
    SpringTerms terms;
    MatrixXd Jp, Jv;
    EvaluateSprings(system, p, MatrixXd::Zero(variant.dim, 5), variant.f, terms);
    SpringJacobian(system, p, MatrixXd::Zero(variant.dim, 5), terms, Jp, Jv);
    EXPECT_TRUE(terms.acc.allFinite() && Jp.allFinite() && Jv.allFinite());
  }
}

TEST(SpringSystem, TopologiesHaveTheirNumbersOfSprings) {
  EXPECT_EQ(SpringTopology("chain4").size(), 4u);
  EXPECT_EQ(SpringTopology("ring5").size(), 5u);
  EXPECT_EQ(SpringTopology("fan7").size(), 7u);
  EXPECT_EQ(SpringTopology("brace9").size(), 9u);
  EXPECT_EQ(SpringTopology("full10").size(), 10u);
  EXPECT_THROW(SpringTopology("star"), Error);
}

TEST(SpringSystem, WrongSystemsAreRefused) {
  SpringSystem system = GraspSystem(true);
  EXPECT_NO_THROW(CheckSpringSystem(system));
  system.springs[0].j = 5;
  EXPECT_THROW(CheckSpringSystem(system), Error);
  system = GraspSystem(true);
  system.mass[2] = 0;
  EXPECT_THROW(CheckSpringSystem(system), Error);
  system = GraspSystem(true);
  system.anchors.resize(3, 5);
  EXPECT_THROW(CheckSpringSystem(system), Error);
}

}  // namespace
}  // namespace springgrasp
