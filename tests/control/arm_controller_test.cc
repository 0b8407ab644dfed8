#include "control/arm_controller.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace springgrasp {
namespace {

// A made-up arm: constant inertia and constant gravity torque, integrated with small steps.
struct Plant {
  ArmVector gravity = ArmVector::LinSpaced(1, 7);
  ArmVector load = ArmVector::Zero();
  RobotState state;
  Plant() {
    state.arm_mass = ArmVector::LinSpaced(2.0, 0.05).asDiagonal();
    state.arm_bias = gravity;
  }
  void Step(const ArmVector& torque, double dt) {
    state.arm_qd += dt * state.arm_mass.inverse() * (torque - gravity - load);
    state.arm_q += dt * state.arm_qd;
  }
};

TEST(ArmControllerTest, HoldsAPostureAgainstGravityExactly) {
  Plant plant;
  ArmControlState memory;
  ArmTarget target;
  for (int i = 0; i < 1000; ++i) {
    plant.Step(ControlArm({}, target, plant.state, 0.002, memory), 0.002);
  }
  EXPECT_LT(plant.state.arm_q.cwiseAbs().maxCoeff(), 1e-9);
}

TEST(ArmControllerTest, FollowsASineWithItsAccelerationFedForward) {
  Plant plant;
  ArmControlState memory;
  const double w = 2 * M_PI * 2, dt = 0.002;
  plant.state.arm_qd.setConstant(0.1 * w);
  double worst = 0;
  for (int i = 0; i < 1000; ++i) {
    const double t = i * dt;
    ArmTarget target;
    target.q.setConstant(0.1 * std::sin(w * t));
    target.qd.setConstant(0.1 * w * std::cos(w * t));
    target.qdd.setConstant(-0.1 * w * w * std::sin(w * t));
    worst = std::max(worst, (target.q - plant.state.arm_q).cwiseAbs().maxCoeff());
    plant.Step(ControlArm({}, target, plant.state, dt, memory), dt);
  }
  EXPECT_LT(worst, 0.005);  // rad, of an amplitude of 0.1
}

TEST(ArmControllerTest, IntegralTakesAwayTheErrorOfAnUnknownLoad) {
  Plant plant;
  plant.load.setConstant(0.3);
  ArmControlState memory;
  for (int i = 0; i < 4000; ++i) {
    plant.Step(ControlArm({}, {}, plant.state, 0.002, memory), 0.002);
  }
  EXPECT_LT(plant.state.arm_q.cwiseAbs().maxCoeff(), 1e-3);
}

}  // namespace
}  // namespace springgrasp
