#include "sim/robot_io.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/random.h"
#include "sim/model_index.h"
#include "sim/sim_fixture.h"

namespace springgrasp {
namespace {

TEST(RobotIoTest, StateIsReadByName) {
  Simulation sim(BuildModel(TestScene()));
  const RobotIo io(sim.model());
  ArmVector arm;
  arm << 0.1, -0.2, 0.3, 0.4, -0.5, 0.6, -0.7;
  HandVector hand(io.layout().num_joints());
  for (int i = 0; i < hand.size(); ++i) hand[i] = 0.05 * (i + 1);
  io.Place(arm, hand, sim);
  sim.Forward();
  const RobotState state = io.Read(sim);
  EXPECT_EQ(state.arm_q, arm);
  EXPECT_EQ(state.hand_q, hand);
  const int ring = IdOf(sim.model(), mjOBJ_JOINT, "hand_r_ring_j1");
  EXPECT_EQ(sim.data().qpos[sim.model().jnt_qposadr[ring]], hand[8]);
  EXPECT_EQ(io.arm_lower[3], 0);
  EXPECT_EQ(io.max_arm_torque[3], 40);
  EXPECT_EQ(io.hand_upper[0], 0.7);
}

TEST(RobotIoTest, MassMatrixIsThatBlockOfTheWhole) {
  Simulation sim(BuildModel(TestScene()));
  const RobotIo io(sim.model());
  RandomEngine engine = MakeStream(3, 0, "mass");
  ArmVector arm;
  for (int i = 0; i < kNumArmJoints; ++i)
    arm[i] = Uniform(engine, io.arm_lower[i], io.arm_upper[i]);
  io.Place(arm, HandVector::Constant(11, 0.4), sim);
  sim.Forward();
  const RobotState state = io.Read(sim);
  const int nv = sim.model().nv;
  std::vector<mjtNum> full(static_cast<std::size_t>(nv) * nv);
  mj_fullM(&sim.model(), full.data(), sim.data().qM);
  for (int i = 0; i < kNumArmJoints; ++i) {
    for (int j = 0; j < kNumArmJoints; ++j) {
      const auto dof = [&](int k) {
        return sim.model()
            .jnt_dofadr[IdOf(sim.model(), mjOBJ_JOINT, "arm_r_" + std::string(kArmJointNames[k]))];
      };
      EXPECT_EQ(state.arm_mass(i, j), full[static_cast<std::size_t>(dof(i)) * nv + dof(j)]);
    }
  }
}

TEST(RobotIoTest, BiasTorqueHoldsTheArmStill) {
  Scene scene = TestScene();
  scene.objects.clear();
  scene.table.position.y() = 3;
  Simulation sim(BuildModel(scene));
  const RobotIo io(sim.model());
  ArmVector arm;
  arm << 0.5, 0.2, 0.1, 0.8, 0.3, -0.2, 0.1;
  // Fingers at their lower limits: the springs press them there, so the hand moves as one.
  io.Place(arm, HandVector::Zero(io.layout().num_joints()), sim);
  sim.Forward();
  for (int k = 0; k < 250; ++k) {
    RobotCommand command;
    command.arm_torque = io.Read(sim).arm_bias;
    io.Write(command, sim);
    sim.Step();
  }
  EXPECT_LT((io.Read(sim).arm_q - arm).cwiseAbs().maxCoeff(), 0.02);
  // Without torque it falls.
  io.Write(RobotCommand{}, sim);
  sim.Step(250);
  EXPECT_GT((io.Read(sim).arm_q - arm).cwiseAbs().maxCoeff(), 0.1);
}

TEST(RobotIoTest, ChambersFillWithTheirTimeConstantAndBendTheirFinger) {
  Scene scene = TestScene();
  scene.objects.clear();
  Simulation sim(BuildModel(scene));
  const RobotIo io(sim.model());
  RobotCommand command;
  command.valve_pressure[3] = 9;  // index proximal, beyond what the compressor has
  const auto step = [&](int steps) {
    for (int k = 0; k < steps; ++k) {
      command.arm_torque = io.Read(sim).arm_bias;
      io.Write(command, sim);
      sim.Step();
    }
  };
  step(50);
  const RobotState state = io.Read(sim);
  EXPECT_NEAR(state.pressure[3], kMaxPressureBar * (1 - std::exp(-1)), 0.05);
  EXPECT_EQ(state.pressure[1], 0);
  step(200);
  EXPECT_GT(io.Read(sim).hand_q[3], 0.5);
  EXPECT_LT(io.Read(sim).hand_q[5], 0.3);
}

TEST(RobotIoTest, MissingPartsAreNamed) {
  Scene scene = TestScene();
  scene.active = {"right_arm"};
  const ModelPtr model = BuildModel(scene);
  try {
    RobotIo io(*model);
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("hand_r_palm"));
  }
}

}  // namespace
}  // namespace springgrasp
