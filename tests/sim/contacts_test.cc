#include "sim/contacts.h"

#include <gmock/gmock.h>

#include "sim/model_index.h"
#include "sim/robot_io.h"
#include "sim/sim_fixture.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

int FirstGeom(const mjModel& m, const std::string& body) {
  return m.body_geomadr[IdOf(m, mjOBJ_BODY, body)];
}

TEST(ContactsTest, GeomsAreWhoTheyAre) {
  const ModelPtr m = BuildModel(TestScene());
  const std::vector<GeomRole> roles = ClassifyGeoms(*m);
  const auto role = [&](const std::string& body) { return roles[FirstGeom(*m, body)]; };
  EXPECT_EQ(role("hand_r_thumb_j0").finger, kThumb);
  EXPECT_EQ(role("hand_r_thumb_j0").phalanx, 0);
  EXPECT_EQ(role("hand_r_pinkie_j1").finger, kPinkie);
  EXPECT_EQ(role("hand_r_pinkie_j1").phalanx, 1);
  EXPECT_EQ(role("hand_r_ring_j1").finger, kRing);
  EXPECT_EQ(role("hand_r_base").part, GeomPart::kPalm);
  EXPECT_EQ(role("hand_r_palm").part, GeomPart::kPalm);
  EXPECT_EQ(role("arm_r_wrist2").part, GeomPart::kArm);
  EXPECT_EQ(role("table").part, GeomPart::kTable);
  EXPECT_EQ(role("ball").part, GeomPart::kObject);
  EXPECT_EQ(role("ball_ring").part, GeomPart::kRing);
  EXPECT_EQ(role("torso").part, GeomPart::kOther);
  EXPECT_EQ(roles[IdOf(*m, mjOBJ_GEOM, "floor")].part, GeomPart::kFloor);
}

TEST(ContactsTest, NormalsPointFromTheFirstToTheSecondAndForcesPush) {
  Scene scene = TestScene();
  BuildOptions options;
  options.with_robot = false;
  Simulation sim(BuildModel(scene, options));
  sim.Step(500);
  ASSERT_GT(sim.contacts().size(), 6u);
  const int table = IdOf(sim.model(), mjOBJ_BODY, "table");
  for (const ContactPoint& c : sim.contacts()) {
    EXPECT_GE(c.normal_force, 0);
    EXPECT_NEAR(c.R_WC.determinant(), 1, 1e-9);
    EXPECT_NEAR(c.f_W.dot(c.R_WC.col(0)), c.normal_force, 1e-9);
    if (c.body1 == table) {
      EXPECT_GT(c.R_WC(2, 0), 0.99);
    }
    if (c.body2 == table) {
      EXPECT_LT(c.R_WC(2, 0), -0.99);
    }
    // Friction stays in its cone; the object's coefficient is in force.
    const double tangential = (c.f_W - c.normal_force * c.R_WC.col(0)).norm();
    EXPECT_LE(tangential, c.friction * c.normal_force * 1.02 + 1e-6);
    const bool ball = NameOf(sim.model(), mjOBJ_BODY, c.body1) == "ball" ||
                      NameOf(sim.model(), mjOBJ_BODY, c.body2) == "ball";
    EXPECT_EQ(c.friction, ball ? 0.8 : 0.9);
  }
}

TEST(ContactsTest, LoadOfASqueezingFingerPointsAwayFromThatFinger) {
  // A can floating before the hand, pressed by the bending index.
  Scene scene = TestScene();
  scene.objects.resize(2);
  scene.objects[0].on_ring = false;
  scene.table.position.y() = 3;
  Simulation sim(BuildModel(scene));
  const RobotIo io(sim.model());
  const Pose X_WH = io.HandPose(sim);
  const int can = IdOf(sim.model(), mjOBJ_BODY, "can");
  const std::vector<GeomRole> roles = ClassifyGeoms(sim.model());
  RobotCommand command;
  command.valve_pressure.setConstant(5);
  HandLoad largest;
  for (int k = 0; k < 300; ++k) {
    // Held in place by the test, so that the finger meets it where we want.
    sim.PlaceBody("can", X_WH * Pose(Eigen::Translation3d(0.14, 0.03, -0.035)) *
                             Eigen::AngleAxisd(1.5708, Eigen::Vector3d::UnitX()));
    command.arm_torque = io.Read(sim).arm_bias;
    io.Write(command, sim);
    sim.Step();
    const HandLoad load = LoadOnBody(sim.contacts(), roles, can);
    if (load.normal[kIndex] > largest.normal[kIndex]) largest = load;
  }
  EXPECT_GT(largest.normal[kIndex], 1);
  EXPECT_LT((X_WH.linear().transpose() * largest.f_W[kIndex]).z(), 0);
  EXPECT_GE(largest.total_normal, largest.normal[kIndex]);
}

}  // namespace
}  // namespace springgrasp
