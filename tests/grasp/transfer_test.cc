#include "grasp/transfer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "grasp/generate.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

// A palm-down enclosing of something 9 cm wide that nobody measured: G has x forward, from the
// thumb to the fingers, and z up to the wrist; y, across the hand, lies level and points to the
// thumb's side of the hand. The fingers stand 6 cm apart along it.
Grasp EnclosingFromAbove() {
  Grasp grasp;
  grasp.type = "power";
  grasp.involved.fill(true);
  grasp.shape = ParseShape("sphere:0.09");
  grasp.tip_radius = 0.008;
  grasp.X_OH = Pose::Identity();
  grasp.X_OH.translation() = Vector3d(-0.05, 0, 0.08);
  grasp.X_HG = grasp.X_OH.inverse();  // G stands as O does
  const double along[kNumFingers] = {0, 0.03, 0.01, -0.01, -0.03};
  for (int f = 0; f < kNumFingers; ++f) {
    const double x = f == kThumb ? -0.053 : std::sqrt(0.053 * 0.053 - along[f] * along[f]);
    grasp.rays[f] = RayOfContact(grasp.shape, {x, along[f], 0});
  }
  grasp.reach.motion = MakeDmp(Eigen::VectorXd::Zero(6), Eigen::VectorXd::Zero(6));
  grasp.reach.motion.x0.head<3>() = Vector3d(-0.2, 0.05, 0.1);
  grasp.reach.motion.weights.setConstant(0.3);
  return grasp;
}

TEST(EncloseAlongAxisTest, TheFingersStandAlongTheCylinderThumbSideUp) {
  const Shape cylinder = ParseShape("cylinder:0.06x0.18");
  const Grasp given = EnclosingFromAbove();
  const Grasp grasp = EncloseAlongAxis(given, cylinder);
  const PerFinger<Contact> contacts = ContactsOn(grasp, cylinder, 0.008);
  const double along[kNumFingers] = {0, 0.03, 0.01, -0.01, -0.03};
  for (int f = 0; f < kNumFingers; ++f) {
    EXPECT_NEAR(contacts[f].p_OC.z(), along[f], 1e-9) << f;
    EXPECT_NEAR(contacts[f].p_OC.head<2>().norm(), 0.03 + 0.008, 1e-9) << f;
  }
  EXPECT_LT(contacts[kThumb].p_OC.x(), 0);
  EXPECT_NEAR(grasp.X_OH.linear()(2, 1), 1, 1e-9) << "y of H, the thumb's side, points up";
  // The way of the reach, as the hand sees it, is what it was.
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(5, 0, 1);
  const auto before = RolloutPoseDmp(given.reach, times).X_WB;
  const auto after = RolloutPoseDmp(grasp.reach, times).X_WB;
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_TRUE((grasp.X_OH.inverse() * after[i]).isApprox(given.X_OH.inverse() * before[i], 1e-9))
        << i;
  }
}

TEST(EncloseAlongAxisTest, OtherGraspsStayAsTheyAre) {
  const Shape cylinder = ParseShape("cylinder:0.06x0.18");
  Grasp given = EnclosingFromAbove();
  EXPECT_TRUE(EncloseAlongAxis(given, ParseShape("sphere:0.06")).X_OH.isApprox(given.X_OH));
  given.object_given = true;
  EXPECT_TRUE(EncloseAlongAxis(given, cylinder).X_OH.isApprox(given.X_OH));
  given.object_given = false;
  given.type = "pinch";
  EXPECT_TRUE(EncloseAlongAxis(given, cylinder).X_OH.isApprox(given.X_OH));
}

// A key grip of a plate, thumb on top, 2 mm from an edge and seen 6 mm apart.
Grasp KeyGrip() {
  Grasp grasp;
  grasp.type = "lateral";
  grasp.involved = {true, true, false, false, false};
  grasp.shape = ParseShape("box:0.08x0.06x0.005");
  grasp.tip_radius = 0.008;
  grasp.X_OH.translation().x() = -0.15;
  grasp.rays[kThumb] = RayOfContact(grasp.shape, {0.008, 0.028, 0.0105});
  grasp.rays[kIndex] = RayOfContact(grasp.shape, {0.002, 0.028, -0.0105});
  return grasp;
}

TEST(PlateContactsTest, LieOppositeEachOtherOnTheFacesOffTheEdges) {
  for (const char* text : {"box:0.08x0.06x0.002", "box:0.08x0.06x0.01", "box:0.16x0.12x0.005"}) {
    const Shape plate = ParseShape(text);
    const PerFinger<Contact> contacts = PlateContacts(KeyGrip(), plate, 0.009, 0.015);
    const Vector3d &thumb = contacts[kThumb].p_OC, &index = contacts[kIndex].p_OC;
    EXPECT_NEAR(thumb.z(), plate.size.z() / 2 + 0.009, 1e-12) << text;
    EXPECT_LT((thumb - Vector3d(index.x(), index.y(), -index.z())).norm(), 1e-12) << text;
    // The end of the longest side where the wrist is.
    EXPECT_NEAR(thumb.x(), 0.015 - plate.size.x() / 2, 1e-12) << text;
    EXPECT_NEAR(thumb.y(), plate.size.y() / 2 - 0.015, 1e-12) << text;
    EXPECT_EQ(contacts[kThumb].n_O, Vector3d(0, 0, 1)) << text;
    EXPECT_EQ(contacts[kIndex].n_O, Vector3d(0, 0, -1)) << text;
  }
  // In the middle of what is narrower than both margins.
  const PerFinger<Contact> narrow =
      PlateContacts(KeyGrip(), ParseShape("box:0.08x0.02x0.005"), 0.009, 0.015);
  EXPECT_EQ(narrow[kThumb].p_OC.y(), 0);
  EXPECT_THROW(PlateContacts(KeyGrip(), ParseShape("sphere:0.04"), 0.009, 0.015), Error);
}

TEST(TransferTest, ContactsAndSpringsOfAnotherGraspAreTakenApart) {
  const Grasp own = EnclosingFromAbove();
  Grasp other = own;
  other.rays[kThumb].direction = -own.rays[kThumb].direction;
  other.X_HG.translation().x() += 0.01;
  other.kc = 2 * own.kc;
  other.edges = {{0, 1, 5, 0.1, 0.2, 0}};
  other.scales.T = 3;

  Grasp contacts = own, springs = own;
  TakeContacts(other, contacts);
  TakeSprings(other, springs);
  EXPECT_EQ(contacts.rays[kThumb].direction, other.rays[kThumb].direction);
  EXPECT_EQ(contacts.X_HG.translation(), other.X_HG.translation());
  EXPECT_EQ(contacts.kc, own.kc);
  EXPECT_EQ(contacts.edges.size(), own.edges.size());
  EXPECT_EQ(springs.kc, other.kc);
  EXPECT_EQ(springs.edges.size(), 1u);
  EXPECT_EQ(springs.rays[kThumb].direction, own.rays[kThumb].direction);
  EXPECT_EQ(springs.scales.T, own.scales.T);
}

}  // namespace
}  // namespace springgrasp
