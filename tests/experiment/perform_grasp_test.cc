#include "experiment/perform_grasp.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/files.h"

namespace springgrasp {
namespace {

// The shipped pinch on a ball, its pose as the scene says.
struct Trial {
  Grasp grasp = ReadGrasp(SourceFolder() + "/experiments/first_grasps/pinch.yaml");
  Scene scene = ReadScene(SourceFolder() + "/scenes/pinch_ball.yaml");
  PerformGraspOptions options;
  TrialResult Run() const { return PerformGrasp(grasp, scene, options); }
};

TEST(PerformGraspTest, AFilmedTrialIsTheSameToTheBit) {
  const TrialResult plain = Trial().Run();
  Trial filmed;
  const std::string video = std::filesystem::temp_directory_path() / "springgrasp_filmed.mp4";
  filmed.options.video = video;
  filmed.options.camera = "close";
  const TrialResult seen = filmed.Run();
  EXPECT_GT(std::filesystem::file_size(video), 10000u);
  std::filesystem::remove(video);
  EXPECT_EQ(plain.outcome, seen.outcome);
  EXPECT_GT(plain.values.size(), 20u);
  EXPECT_EQ(plain.values, seen.values);
}

// Softer contacts leave the plan as it was; a robot that believes in another place plans anew.
TEST(PerformGraspTest, AKeptPlanChangesNoResult) {
  PlanMemory plans;
  Trial trial;
  trial.options.plan_key = "as shipped";
  PerformGrasp(trial.grasp, trial.scene, trial.options, plans);
  trial.scene.physics.solref = {0.02, 1};
  const TrialResult kept = PerformGrasp(trial.grasp, trial.scene, trial.options, plans);
  EXPECT_EQ(kept.values, trial.Run().values);
}

TEST(PerformGraspTest, TheHandWithAnOppositionJointRunsTheSameChain) {
  Trial trial;
  trial.scene.hand = "opposition";
  const TrialResult result = trial.Run();
  EXPECT_NE(result.outcome, Outcome::kError) << result.message;
  EXPECT_NE(result.outcome, Outcome::kDiverged) << result.message;
  EXPECT_NE(result.outcome, Outcome::kUnreachable) << result.message;
}

TEST(PerformGraspTest, TheLeftHandPerformsTheMirroredPowerGrasp) {
  Trial trial;
  trial.grasp = ReadGrasp(SourceFolder() + "/models/grasps/power.yaml");
  trial.scene = ReadScene(SourceFolder() + "/scenes/power_cylinder_left.yaml");
  const TrialResult result = trial.Run();
  EXPECT_EQ(result.outcome, Outcome::kSuccess) << result.message;
  EXPECT_LT(result.values.at("arm_late_error_mm"), 3);
  EXPECT_LT(result.values.at("arm_late_error_deg"), 1.5);
  EXPECT_LT(result.values.at("arm_hold_error_mm"), 3);
}

// With torso and platform free to move, too: the arm carries its load all the same.
TEST(PerformGraspTest, ALateralGraspHoldsAPlate) {
  Trial trial;
  trial.grasp = ReadGrasp(SourceFolder() + "/models/grasps/lateral.yaml");
  trial.scene = ReadScene(SourceFolder() + "/scenes/lateral_plate.yaml");
  const TrialResult result = trial.Run();
  EXPECT_EQ(result.outcome, Outcome::kSuccess) << result.message;
  EXPECT_LT(result.values.at("arm_hold_error_mm"), 3);
  EXPECT_GT(result.values.at("opposition_deg"), 120);
}

TEST(PerformGraspTest, APinchHoldsTheForceItChoseAndStaysBelowTheLimit) {
  Trial trial;
  trial.scene.objects[0].believed.friction = 0.25;
  const TrialResult result = trial.Run();
  ASSERT_EQ(result.outcome, Outcome::kSuccess) << result.message;
  for (const char* finger : {"thumb", "index"}) {
    const double target = result.values.at(fmt::format("force_target_{}_n", finger));
    EXPECT_NEAR(result.values.at(fmt::format("force_hold_{}_n", finger)), target, 0.15 * target);
    EXPECT_LT(result.values.at(fmt::format("largest_force_{}_n", finger)),
              trial.scene.max_finger_force);
  }
}

TEST(PerformGraspTest, ExactJointsAreWhereTheyArePlanned) {
  const Grasp grasp = ReadGrasp(SourceFolder() + "/models/grasps/pinch.yaml");
  const Scene scene = ReadScene(SourceFolder() + "/scenes/pinch_ball.yaml");
  PerformGraspOptions options;
  const TrialResult driven = PerformGrasp(grasp, scene, options);
  options.exact_arm = options.exact_fingers = true;
  const TrialResult exact = PerformGrasp(grasp, scene, options);
  EXPECT_EQ(OutcomeName(exact.outcome), "success") << exact.message;
  EXPECT_LT(exact.values.at("arm_late_error_mm"), 0.2 * driven.values.at("arm_late_error_mm"));
  EXPECT_LT(exact.values.at("finger_error_mm"), 0.5 * driven.values.at("finger_error_mm"));
}

TEST(PerformGraspTest, SensorNoiseFollowsTheActuationStream) {
  const auto run = [](std::uint64_t seed) {
    Trial trial;
    trial.scene.pneumatics.pressure_noise = 0.02;
    trial.scene.pneumatics.angle_noise = 0.002;
    trial.options.actuation = MakeStream(seed, 0, "actuation");
    return trial.Run().values;
  };
  const auto first = run(1);
  EXPECT_EQ(first, run(1));
  EXPECT_NE(first, run(2));
}

}  // namespace
}  // namespace springgrasp
