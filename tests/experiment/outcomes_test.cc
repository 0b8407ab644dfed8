// Every outcome that physics can give is reached by a scene made for it.
#include <gtest/gtest.h>

#include "base/files.h"
#include "experiment/perform_grasp.h"

namespace springgrasp {
namespace {

// A shipped grasp on its shipped scene, the object where the scene says.
struct Trial {
  explicit Trial(const std::string& type = "pinch", const std::string& scene_name = "pinch_ball")
      : grasp(ReadGrasp(SourceFolder() + "/models/grasps/" + type + ".yaml")),
        scene(ReadScene(SourceFolder() + "/scenes/" + scene_name + ".yaml")) {}
  SceneObject& object() { return scene.objects[0]; }
  TrialResult Run() const { return PerformGrasp(grasp, scene, options); }

  Grasp grasp;
  Scene scene;
  PerformGraspOptions options;
};

void ExpectOutcome(const Trial& trial, Outcome wanted, const std::string& phase) {
  const TrialResult result = trial.Run();
  EXPECT_EQ(OutcomeName(result.outcome), OutcomeName(wanted)) << result.message;
  EXPECT_EQ(result.phase, phase) << result.message;
  EXPECT_EQ(result.message.empty(), wanted == Outcome::kSuccess);
}

TEST(OutcomesTest, ABallIsPinchedHeldAndShaken) {
  ExpectOutcome(Trial(), Outcome::kSuccess, "done");
}

TEST(OutcomesTest, WhatIsHeldStillIsCarriedByItsContacts) {
  for (const char* type : {"pinch", "power"}) {
    const TrialResult result =
        Trial(type, type == std::string("pinch") ? "pinch_ball" : "power_cylinder").Run();
    ASSERT_TRUE(result.values.count("weight_error")) << type << ": " << result.message;
    EXPECT_LT(result.values.at("weight_error"), 0.05) << type;
  }
}

TEST(OutcomesTest, ACylinderIsSetDownWhereItShallStand) {
  Trial trial("power", "power_cylinder");
  trial.object().place = Eigen::Vector2d(0.33, 0.53);
  const TrialResult result = trial.Run();
  EXPECT_EQ(OutcomeName(result.outcome), "success") << result.message;
  EXPECT_LT(result.values.at("place_error_mm"), 20);
  EXPECT_LT(result.values.at("place_tilt_deg"), 10);
}

TEST(OutcomesTest, WhatIsSetDownBeyondTheEdgeFalls) {
  Trial trial("power", "power_cylinder");
  trial.object().place = Eigen::Vector2d(0.33, 0.53);
  // The table ends below the middle of where it shall stand.
  trial.scene.table.position.y() += 0.545 - (0.66 - 0.25);
  trial.object().X_WO.translation().y() = 0.58;
  ExpectOutcome(trial, Outcome::kDroppedPlace, "done");
}

TEST(OutcomesTest, AnObjectBehindTheTableIsUnreachable) {
  Trial trial;
  trial.object().X_WO.translation().y() += 0.6;
  ExpectOutcome(trial, Outcome::kUnreachable, "plan");
}

TEST(OutcomesTest, ARobotThatWouldBeginInTheCylinderBeginsElsewhereIfItMay) {
  Trial trial("side/tripod", "tripod_side");
  trial.object().X_WO.translation().head<2>() = Eigen::Vector2d(0.285, 0.441);
  ExpectOutcome(trial, Outcome::kUnreachable, "plan");
  trial.scene.active = {"right_arm", "right_hand", "torso", "platform"};
  const TrialResult result = trial.Run();
  EXPECT_EQ(OutcomeName(result.outcome), "success") << result.message;
  EXPECT_NE(result.values.at("start_torso_yaw"), 0);
}

TEST(OutcomesTest, WhoTakesTheCylinderForFartherPushesIt) {
  Trial trial("power", "power_cylinder");
  trial.object().believed.position.y() = 0.05;
  ExpectOutcome(trial, Outcome::kCollided, "reach");
}

TEST(OutcomesTest, WhoTakesTheBallForElsewhereMissesIt) {
  Trial trial;
  trial.object().believed.position.x() = 0.06;
  ExpectOutcome(trial, Outcome::kMissed, "grip");
}

TEST(OutcomesTest, AHeavySlipperyBallIsNotLifted) {
  Trial trial;
  trial.object().mass = 0.5;
  trial.object().friction = 0.1;
  trial.scene.max_finger_force = 5;
  ExpectOutcome(trial, Outcome::kDroppedLift, "lift");
}

// Pyramidal friction cones creep: what was lifted slides out of the fingers.
TEST(OutcomesTest, WhatCreepsIsDroppedInTheHold) {
  Trial trial;
  trial.scene.physics.cone = "pyramidal";
  trial.scene.physics.impratio = 2;
  trial.scene.physics.noslip_iterations = 0;
  trial.scene.max_finger_force = 3;
  trial.options.criteria.hold = 6;
  ExpectOutcome(trial, Outcome::kDroppedHold, "hold");
}

TEST(OutcomesTest, AForceOfFifteenTimesItsWeightTearsTheBallOff) {
  Trial trial;
  trial.options.criteria.force_per_mass = 150;  // N/kg
  ExpectOutcome(trial, Outcome::kDroppedDisturb, "disturb");
}

TEST(OutcomesTest, ABallThatRollsInTheHandHasSlipped) {
  Trial trial;
  trial.options.criteria.max_slip = 0.001;
  ExpectOutcome(trial, Outcome::kSlipped, "done");
}

TEST(OutcomesTest, APinchIsNoTripod) {
  Trial trial;
  trial.grasp.type = "tripod";
  ExpectOutcome(trial, Outcome::kWrongContacts, "done");
}

TEST(OutcomesTest, ContactsStifferThanTheTimestepAllowsDiverge) {
  Trial trial;
  trial.scene.physics.timestep = 0.01;
  trial.scene.physics.solref = {1e-4, 1e-4};
  ExpectOutcome(trial, Outcome::kDiverged, "settle");
}

}  // namespace
}  // namespace springgrasp
