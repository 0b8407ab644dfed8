#include "grasp/object_contacts.h"

#include <gtest/gtest.h>

#include <numbers>

#include "base/random.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

std::vector<Shape> Shapes() {
  return {ParseShape("sphere:0.04"), ParseShape("cylinder:0.05x0.2"),
          ParseShape("box:0.03x0.06x0.12")};
}

Vector3d RandomPoint(RandomEngine& engine, double size) {
  return {Uniform(engine, -size, size), Uniform(engine, -size, size), Uniform(engine, -size, size)};
}

TEST(ObjectContactsTest, NormalIsTheGradientOfTheSignedDistance) {
  RandomEngine engine = MakeStream(1, 0, "test");
  constexpr double kStep = 1e-7;
  for (const Shape& shape : Shapes()) {
    int checked = 0;
    for (int i = 0; i < 200; ++i) {
      const Vector3d p = RandomPoint(engine, 0.15);
      if (SignedDistance(shape, p) < 1e-3) continue;  // inside there are kinks between faces
      Vector3d gradient;
      for (int c = 0; c < 3; ++c) {
        const Vector3d e = kStep * Vector3d::Unit(c);
        gradient[c] = (SignedDistance(shape, p + e) - SignedDistance(shape, p - e)) / (2 * kStep);
      }
      EXPECT_LT((gradient - OutwardNormal(shape, p)).norm(), 1e-4) << p.transpose();
      ++checked;
    }
    EXPECT_GT(checked, 50);
  }
}

TEST(ObjectContactsTest, NearestSurfacePointLiesOnTheSurface) {
  RandomEngine engine = MakeStream(2, 0, "test");
  for (const Shape& shape : Shapes()) {
    for (int i = 0; i < 100; ++i) {
      const Vector3d s = NearestSurfacePoint(shape, RandomPoint(engine, 0.1));
      EXPECT_NEAR(SignedDistance(shape, s), 0, 1e-12);
    }
    EXPECT_TRUE(OutwardNormal(shape, Vector3d::Zero()).allFinite());
  }
}

TEST(ObjectContactsTest, RayLeavesOnTheSurfaceInItsDirection) {
  RandomEngine engine = MakeStream(3, 0, "test");
  for (const Shape& shape : Shapes()) {
    for (int i = 0; i < 100; ++i) {
      const Vector3d d = RandomPoint(engine, 1).normalized();
      const auto hit = RayExit(shape, Vector3d::Zero(), d);
      ASSERT_TRUE(hit.has_value());
      EXPECT_NEAR(SignedDistance(shape, *hit), 0, 1e-12);
      EXPECT_NEAR(hit->normalized().dot(d), 1, 1e-12);
    }
    EXPECT_FALSE(RayExit(shape, Vector3d(1, 0, 0), Vector3d::UnitY()).has_value());
    EXPECT_FALSE(RayExit(shape, Vector3d(1, 0, 0), Vector3d::UnitX()).has_value());
    EXPECT_FALSE(RayExit(shape, Vector3d::Zero(), Vector3d::Zero()).has_value());
  }
}

TEST(ObjectContactsTest, ContactOfARayIsOneTipRadiusOutside) {
  RandomEngine engine = MakeStream(4, 0, "test");
  constexpr double kTip = 0.009;
  for (const Shape& shape : Shapes()) {
    for (int i = 0; i < 200; ++i) {
      const ContactRay ray = RayOfContact(shape, RandomPoint(engine, 0.08));
      EXPECT_LE(std::abs(ray.height), 0.5);
      const auto contact = ContactOfRay(shape, ray, kTip);
      ASSERT_TRUE(contact.has_value());
      EXPECT_NEAR(SignedDistance(shape, contact->p_OC), kTip, 1e-7);
      EXPECT_NEAR(contact->n_O.norm(), 1, 1e-12);
    }
  }
}

TEST(ObjectContactsTest, RayOfAContactLeadsBackToIt) {
  RandomEngine engine = MakeStream(5, 0, "test");
  constexpr double kTip = 0.01;
  for (const Shape& shape : Shapes()) {
    for (int i = 0; i < 100; ++i) {
      // Somewhere on the side, away from edges.
      Vector3d d = RandomPoint(engine, 1);
      d.z() = 0;
      const Vector3d start(0, 0, Uniform(engine, -0.4, 0.4) * shape.size.z());
      const Vector3d s = *RayExit(shape, start, d);
      const Vector3d p = s + kTip * OutwardNormal(shape, s + 1e-6 * d.normalized());
      const auto contact = ContactOfRay(shape, RayOfContact(shape, p), kTip);
      ASSERT_TRUE(contact.has_value());
      EXPECT_LT((contact->p_OC - p).norm(), 1e-5) << p.transpose();
    }
  }
}

TEST(ObjectContactsTest, RayCarriesHeightAsAFraction) {
  const ContactRay ray = RayOfContact(ParseShape("cylinder:0.05x0.2"), Vector3d(0.035, 0, 0.05));
  EXPECT_NEAR(ray.height, 0.25, 1e-12);
  const auto contact = ContactOfRay(ParseShape("box:0.06x0.06x0.1"), ray, 0.01);
  ASSERT_TRUE(contact.has_value());
  EXPECT_LT((contact->p_OC - Vector3d(0.04, 0, 0.025)).norm(), 1e-12);
}

TEST(ObjectContactsTest, MeanSectionRadiusOfRoundSectionsIsTheirRadius) {
  EXPECT_NEAR(MeanSectionRadius(ParseShape("sphere:0.04"), Vector3d(1, 2, 3)), 0.02, 1e-12);
  EXPECT_NEAR(MeanSectionRadius(ParseShape("cylinder:0.05x0.2"), Vector3d::UnitZ()), 0.025, 1e-12);
  // Mean distance of a square's outline over direction: 4 s / pi * asinh(1), s half the side.
  EXPECT_NEAR(MeanSectionRadius(ParseShape("box:0.04x0.04x0.1"), Vector3d::UnitZ()),
              0.02 * 4 / std::numbers::pi * std::asinh(1.0), 1e-6);
}

TEST(ObjectContactsTest, SymmetryRotationsLeaveTheShapeUnchanged) {
  RandomEngine engine = MakeStream(6, 0, "test");
  std::vector<Shape> shapes = Shapes();
  shapes.push_back(ParseShape("box:0.05x0.05x0.12"));
  shapes.push_back(ParseShape("box:0.05x0.05x0.05"));
  for (const Shape& shape : shapes) {
    const Symmetry symmetry = SymmetryOf(shape);
    ASSERT_FALSE(symmetry.rotations.empty());
    EXPECT_LT(symmetry.rotations[0].angularDistance(Eigen::Quaterniond::Identity()), 1e-12);
    std::vector<Eigen::Quaterniond> rotations = symmetry.rotations;
    for (const double yaw : FreeYaws(shape, 12)) {
      rotations.emplace_back(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
    }
    for (const auto& R : rotations) {
      for (int i = 0; i < 20; ++i) {
        const Vector3d p = RandomPoint(engine, 0.1);
        EXPECT_NEAR(SignedDistance(shape, p), SignedDistance(shape, R * p), 1e-12);
      }
    }
  }
  EXPECT_EQ(SymmetryOf(shapes[2]).rotations.size(), 4u);
  EXPECT_EQ(SymmetryOf(shapes[3]).rotations.size(), 8u);
  EXPECT_EQ(SymmetryOf(shapes[4]).rotations.size(), 24u);
  EXPECT_EQ(FreeYaws(shapes[2], 12).size(), 2u);
  EXPECT_EQ(FreeYaws(shapes[3], 12).size(), 4u);
  EXPECT_EQ(FreeYaws(shapes[0], 12).size(), 12u);
}

}  // namespace
}  // namespace springgrasp
