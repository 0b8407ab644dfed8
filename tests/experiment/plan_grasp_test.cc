#include "experiment/plan_grasp.h"

#include <gmock/gmock.h>

#include "base/files.h"
#include "sim/robot_io.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

using testing::HasSubstr;

// The shipped side tripod, its cylinder where the scene says.
struct Planning {
  Scene scene = ReadScene(SourceFolder() + "/scenes/tripod_side.yaml");
  Grasp grasp = ReadGrasp(SourceFolder() + "/models/grasps/side/tripod.yaml");
  Simulation simulation{BuildModel(scene, {})};
  RobotBody body = MakeRobotBody(simulation, "r");
  PlanRequest request;
  Planning() {
    request.object = BelieveObject(scene, 0);
    request.table_height = scene.table.height;
    request.table_edge = scene.table.position.y() - scene.table.size.y() / 2;
    request.arm_start = RobotIo(simulation.model(), "r").Read(simulation).arm_q;
  }
  PlanResult Plan() const { return PlanGrasp(body, grasp, request); }
};

TEST(PlanGraspTest, TheArmEndsWhereTheHandHoldsTheObject) {
  const Planning planning;
  const PlanResult result = planning.Plan();
  ASSERT_TRUE(result.plan) << result.reason;
  const GraspPlan& plan = *result.plan;
  const Pose X_WH = HandPose(planning.body.arm, plan.arm.back());
  EXPECT_LT((X_WH.translation() - plan.X_WH.back().translation()).norm(), 1e-4);
  const Pose X_WO = X_WH * plan.X_HO;
  EXPECT_LT((X_WO.translation() - planning.request.object.X_WO.translation()).norm(), 1e-3);
}

TEST(PlanGraspTest, AnObjectWhereTheRobotStandsIsRefused) {
  Planning planning;
  const Pose X_WH = HandPose(planning.body.arm, planning.request.arm_start);
  for (const double ahead : {0.0, 0.1, -0.15}) {  // palm, fingers, forearm
    planning.request.object.X_WO.translation() = X_WH * Eigen::Vector3d(ahead, 0, 0);
    const PlanResult result = planning.Plan();
    EXPECT_FALSE(result.plan);
    EXPECT_THAT(result.reason, HasSubstr("from the start"));
  }
}

}  // namespace
}  // namespace springgrasp
