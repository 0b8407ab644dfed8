#include "experiment/verdict.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

const Shape kBall{Shape::Kind::kSphere, Eigen::Vector3d::Constant(0.04)};
const Shape kCan{Shape::Kind::kCylinder, Eigen::Vector3d(0.05, 0.05, 0.16)};

void Touch(ContactWindow& w, int finger, const Eigen::Vector3d& f_H, const Eigen::Vector3d& p_O,
           int phalanx = 1) {
  w.normal[finger] += f_H.norm();
  w.f_H[finger] += f_H;
  if (phalanx == 0) w.proximal_normal[finger] += f_H.norm();
  w.total_normal += f_H.norm();
  MeanContact c;
  c.role = {GeomPart::kFinger, finger, phalanx};
  c.normal = f_H.norm();
  c.geometry.p = p_O;
  c.geometry.n = f_H.normalized();
  w.contacts.push_back(c);
}

ContactWindow Pinch() {
  ContactWindow w;
  w.duration = 0.5;
  Touch(w, kThumb, {0, 0, 3}, {0, 0, -0.02});
  Touch(w, kIndex, {0, 0, -3}, {0, 0, 0.02});
  return w;
}

TEST(VerdictTest, ThumbAgainstIndexIsAPinch) {
  const ContactCheck check = CheckContacts("pinch", Pinch(), kBall, {});
  EXPECT_TRUE(check.ok) << check.reason;
  EXPECT_NEAR(check.opposition_deg, 180, 1e-6);
  EXPECT_GT(check.epsilon, 0);
}

TEST(VerdictTest, PinchCarriedByTheMiddleFingerIsNoPinch) {
  ContactWindow w = Pinch();
  Touch(w, kMiddle, {0, 0, -1}, {0.01, 0, 0.017});
  EXPECT_FALSE(CheckContacts("pinch", w, kBall, {}).ok);
  EXPECT_TRUE(CheckContacts("tripod", w, kBall, {}).ok);
}

TEST(VerdictTest, ScoopingIsNoPinch) {
  // Both fingers from below: they bear the ball but do not oppose each other.
  ContactWindow w;
  w.duration = 0.5;
  Touch(w, kThumb, {0.3, 0, 1}, {-0.005, 0, -0.019});
  Touch(w, kIndex, {-0.3, 0, 1}, {0.005, 0, -0.019});
  const ContactCheck check = CheckContacts("pinch", w, kBall, {});
  EXPECT_FALSE(check.ok);
  EXPECT_LT(check.opposition_deg, 120);
}

TEST(VerdictTest, LightTouchIsNoContact) {
  ContactWindow w;
  w.duration = 0.5;
  Touch(w, kThumb, {0, 0, 0.2}, {0, 0, -0.02});
  Touch(w, kIndex, {0, 0, -0.2}, {0, 0, 0.02});
  EXPECT_FALSE(CheckContacts("pinch", w, kBall, {}).ok);
}

TEST(VerdictTest, PowerNeedsThumbTwoFingersAndPalmOrAThird) {
  ContactWindow w;
  w.duration = 0.5;
  Touch(w, kThumb, {0, 0, 3}, {0, 0, -0.025});
  Touch(w, kIndex, {0, 0, -2}, {0, 0.02, 0.025});
  Touch(w, kMiddle, {0, 0, -2}, {0, -0.02, 0.025});
  EXPECT_FALSE(CheckContacts("power", w, kCan, {}).ok);
  ContactWindow with_ring = w;
  Touch(with_ring, kRing, {0, 0, -1}, {0, -0.04, 0.025}, 0);
  EXPECT_TRUE(CheckContacts("power", with_ring, kCan, {}).ok);
  ContactWindow with_palm = w;
  with_palm.palm_normal = 1;
  with_palm.palm_f_H = Eigen::Vector3d(0.5, 0, -1);
  EXPECT_TRUE(CheckContacts("power", with_palm, kCan, {}).ok);
}

TEST(VerdictTest, ProximalPhalangesCountAsPalmForWideObjectsOnly) {
  ContactWindow w;
  w.duration = 0.5;
  Touch(w, kThumb, {0, 0, 3}, {0, 0, -0.04});
  Touch(w, kIndex, {0, 0, -2}, {0, 0.02, 0.04}, 0);
  Touch(w, kMiddle, {0, 0, -2}, {0, -0.02, 0.04}, 0);
  const Shape wide{Shape::Kind::kCylinder, Eigen::Vector3d(0.08, 0.08, 0.16)};
  EXPECT_TRUE(CheckContacts("power", w, wide, {}).ok);
  EXPECT_FALSE(CheckContacts("power", w, kCan, {}).ok);
}

TEST(VerdictTest, LateralAsksForTheRadialSideOfTheIndex) {
  const Shape card{Shape::Kind::kBox, Eigen::Vector3d(0.05, 0.005, 0.08)};
  ContactWindow radial;
  radial.duration = 0.5;
  Touch(radial, kThumb, {0, -2, 0}, {0, 0.0025, 0});
  Touch(radial, kIndex, {0, 2, 0}, {0, -0.0025, 0});
  EXPECT_TRUE(CheckContacts("lateral", radial, card, {}).ok);
  ContactWindow ulnar;  // y of H points to the thumb's side
  ulnar.duration = 0.5;
  Touch(ulnar, kThumb, {0, 2, 0}, {0, -0.0025, 0});
  Touch(ulnar, kIndex, {0, -2, 0}, {0, 0.0025, 0});
  EXPECT_FALSE(CheckContacts("lateral", ulnar, card, {}).ok);
  ContactWindow proximal;
  proximal.duration = 0.5;
  Touch(proximal, kThumb, {0, -2, 0}, {0, 0.0025, 0});
  Touch(proximal, kIndex, {0, 2, 0}, {0, -0.0025, 0}, 0);
  EXPECT_FALSE(CheckContacts("lateral", proximal, card, {}).ok);
  ContactWindow back;
  back.duration = 0.5;
  Touch(back, kThumb, {0, 0, 2}, {0, 0, -0.04});
  Touch(back, kIndex, {0, 0, -2}, {0, 0, 0.04});
  EXPECT_FALSE(CheckContacts("lateral", back, card, {}).ok);
}

TEST(VerdictTest, WhatHappensFirstWinsAndDivergenceBeforeAll) {
  const std::vector<TrialEvent> events = {{3, Outcome::kSlipped, "s"},
                                          {2, Outcome::kDroppedHold, "d"}};
  EXPECT_EQ(DecideOutcome(events).outcome, Outcome::kDroppedHold);
  std::vector<TrialEvent> diverged = events;
  diverged.push_back({9, Outcome::kDiverged, "x"});
  EXPECT_EQ(DecideOutcome(diverged).outcome, Outcome::kDiverged);
  EXPECT_EQ(DecideOutcome({}).outcome, Outcome::kSuccess);
}

}  // namespace
}  // namespace springgrasp
