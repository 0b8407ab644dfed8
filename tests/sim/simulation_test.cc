#include "sim/simulation.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "sim/model_index.h"
#include "sim/robot_io.h"
#include "sim/sim_fixture.h"

namespace springgrasp {
namespace {

constexpr double kGravity = 9.81;

Scene ObjectsOnly() {
  Scene scene = TestScene();
  scene.start.clear();
  return scene;
}

BuildOptions WithoutRobot() {
  BuildOptions options;
  options.with_robot = false;
  return options;
}

TEST(SimulationTest, ObjectsRestWhereTheyStartAndTheirWeightIsCarried) {
  Simulation sim(BuildModel(ObjectsOnly(), WithoutRobot()));
  const mjModel& m = sim.model();
  std::vector<Pose> start;
  for (const char* name : {"ball", "can", "block"}) start.push_back(BodyPose(m, sim.data(), name));
  sim.Step(1000);
  ASSERT_FALSE(sim.diverged()) << sim.diverged()->warning;
  const double masses[] = {0.1, 0.3, 0.2};
  for (int i = 0; const char* name : {"ball", "can", "block"}) {
    const int body = IdOf(m, mjOBJ_BODY, name);
    const BodyState s = ReadBodyState(m, sim.data(), body);
    EXPECT_LT((s.X_WB.translation() - start[i].translation()).norm(), 5e-4) << name;
    EXPECT_LT(s.v_WC.norm(), 1e-3) << name;
    Eigen::Vector3d f = Eigen::Vector3d::Zero();
    for (const ContactPoint& c : sim.contacts()) {
      if (c.body2 == body) f += c.f_W;
      if (c.body1 == body) f -= c.f_W;
    }
    EXPECT_NEAR(f.z(), masses[i] * kGravity, 0.02 * masses[i] * kGravity) << name;
    EXPECT_LT(f.head<2>().norm(), 0.02 * masses[i] * kGravity) << name;
    ++i;
  }
}

TEST(SimulationTest, ForceAtTheCentreOfMassAccelerates) {
  BuildOptions options = WithoutRobot();
  options.with_table = false;
  Simulation sim(BuildModel(ObjectsOnly(), options));
  const int can = IdOf(sim.model(), mjOBJ_BODY, "can");
  sim.ApplyForce("can", {0.6, 0, 0.3 * kGravity});
  sim.Step(50);
  const BodyState s = ReadBodyState(sim.model(), sim.data(), can);
  EXPECT_NEAR(s.v_WC.x(), 0.6 / 0.3 * 0.1, 1e-6);
  EXPECT_NEAR(s.v_WC.z(), 0, 1e-6);
  EXPECT_LT(s.w_WB.norm(), 1e-9);
}

TEST(SimulationTest, VelocityOfTheCentreOfMassIsTheDerivativeOfItsPosition) {
  Simulation sim(BuildModel(TestScene()));
  const int hand = IdOf(sim.model(), mjOBJ_BODY, "hand_r_index_j1");
  sim.Step(100);
  const BodyState before = ReadBodyState(sim.model(), sim.data(), hand);
  sim.Step(1);
  const BodyState after = ReadBodyState(sim.model(), sim.data(), hand);
  // The engine moves on with the new velocity; the rest is the turning within one step.
  const Eigen::Vector3d v = (after.p_WC - before.p_WC) / sim.timestep();
  EXPECT_GT(v.norm(), 0.05);
  EXPECT_LT((v - after.v_WC).norm(), 0.05 * v.norm());
}

TEST(SimulationTest, RestoringRepeatsTheFutureToTheBit) {
  Simulation sim(BuildModel(TestScene()));
  const RobotIo io(sim.model());
  RobotCommand command;
  command.valve_pressure.setConstant(3);
  command.arm_torque.setConstant(1);
  io.Write(command, sim);
  sim.ApplyForce("can", {0.2, 0.1, 0});
  sim.Step(150);
  const Snapshot snapshot = sim.TakeSnapshot();
  sim.Step(150);
  const Snapshot first = sim.TakeSnapshot();
  sim.Step(37);
  sim.Restore(snapshot);
  sim.Step(150);
  const Snapshot second = sim.TakeSnapshot();
  EXPECT_EQ(first.time, second.time);
  EXPECT_EQ(first.qpos, second.qpos);
  EXPECT_EQ(first.qvel, second.qvel);
  EXPECT_EQ(first.act, second.act);
}

TEST(SimulationTest, SameAsPlainStepping) {
  Simulation sim(BuildModel(TestScene()));
  const ModelPtr model = BuildModel(TestScene());
  const DataPtr data = MakeData(*model);
  mj_resetDataKeyframe(model.get(), data.get(), 0);
  sim.Step(200);
  for (int i = 0; i < 200; ++i) mj_step(model.get(), data.get());
  for (int i = 0; i < model->nq; ++i) EXPECT_EQ(sim.data().qpos[i], data->qpos[i]) << i;
}

TEST(SimulationTest, DivergenceIsAStateNotACrash) {
  Simulation sim(BuildModel(TestScene()));
  sim.mutable_data().qpos[0] = 1e12;
  sim.Step(10);
  ASSERT_TRUE(sim.diverged());
  EXPECT_THAT(sim.diverged()->warning, ::testing::HasSubstr("bad number"));
  const double stopped = sim.time();
  sim.Step(10);
  EXPECT_EQ(sim.time(), stopped);
  sim.Reset();
  sim.Step(10);
  EXPECT_FALSE(sim.diverged());
  sim.SetControl("arm_r_elbow", std::numeric_limits<double>::quiet_NaN());
  sim.Step(2);
  EXPECT_TRUE(sim.diverged());
}

TEST(SimulationTest, ImpossibleSpeedsAreDivergence) {
  Simulation sim(BuildModel(TestScene()));
  sim.mutable_data().qvel[0] = 1e5;
  sim.Step();
  ASSERT_TRUE(sim.diverged());
  EXPECT_THAT(sim.diverged()->warning, ::testing::HasSubstr("1000 m/s"));
}

TEST(SimulationTest, EngineErrorsAreCaughtInAStep) {
  Simulation sim(BuildModel(TestScene()));
  sim.mutable_data().nstack = 8;  // far too small: the engine calls mju_error, which must not exit
  sim.Step();
  ASSERT_TRUE(sim.diverged());
  EXPECT_THAT(sim.diverged()->warning, ::testing::HasSubstr("MuJoCo"));
}

TEST(SimulationTest, PlacingWorksOnFreeBodiesOnly) {
  Simulation sim(BuildModel(TestScene()));
  const Pose X = MakePose({0.1, 0.5, 1.3}, Eigen::Quaterniond(0.5, 0.5, 0.5, 0.5));
  sim.PlaceBody("can", X);
  sim.Forward();
  EXPECT_TRUE(BodyPose(sim.model(), sim.data(), "can").isApprox(X, 1e-12));
  EXPECT_THROW(sim.PlaceBody("table", X), Error);
  EXPECT_THROW(sim.PlaceBody("cup", X), Error);
  EXPECT_THROW(sim.SetJoint("can_free", 1), Error);
}

}  // namespace
}  // namespace springgrasp
