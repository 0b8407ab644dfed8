#include "sim/pneumatics.h"

#include <gmock/gmock.h>

#include <cmath>

#include "base/error.h"
#include "sim/measure_drives.h"
#include "sim/model_index.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

constexpr double kDt = 0.002;

// A chamber as the engine fills it, behind the drives under test.
ValveVector Fill(PneumaticDrives& drives, const ValveVector& command, ValveVector pressure,
                 double duration, double fill_time = 0.1) {
  for (int i = 0; i < std::lround(duration / kDt); ++i) {
    pressure += kDt / fill_time * (drives.Step(command, pressure) - pressure);
  }
  return pressure;
}

TEST(PneumaticsTest, WithNothingSetCommandsAndReadingsPassUnchanged) {
  PneumaticDrives drives({}, kDt, MakeStream(1, 0, "actuation"));
  ValveVector command;
  command << 0, 0.5, 1, 1.5, 2, 3, 4, 5;
  EXPECT_EQ(drives.Step(command, ValveVector::Constant(2)), command);
  RobotState state;
  state.pressure = command;
  state.hand_q = HandVector::LinSpaced(11, 0, 1);
  const RobotState before = state;
  drives.Sense(state);
  EXPECT_EQ(state.pressure, before.pressure);
  EXPECT_EQ(state.hand_q, before.hand_q);
}

TEST(PneumaticsTest, ADelayedCommandArrivesLaterUnchanged) {
  PneumaticParameters p;
  p.delay = 0.05;
  PneumaticDrives drives(p, kDt, RandomEngine(1));
  for (int i = 0; i < 100; ++i) {
    const double u = drives.Step(ValveVector::Constant(0.01 * i), ValveVector::Zero())[3];
    EXPECT_NEAR(u, i < 25 ? 0 : 0.01 * (i - 25), 1e-12);
  }
}

TEST(PneumaticsTest, PlayLeavesTheSpoolBehindByHalfItsWidthBothWays) {
  PneumaticParameters p;
  p.hysteresis = 0.4;
  PneumaticDrives drives(p, kDt, RandomEngine(1));
  EXPECT_NEAR(drives.Step(ValveVector::Constant(2), ValveVector::Zero())[0], 1.8, 1e-12);
  EXPECT_NEAR(drives.Step(ValveVector::Constant(1.7), ValveVector::Zero())[0], 1.8, 1e-12);
  EXPECT_NEAR(drives.Step(ValveVector::Constant(1.0), ValveVector::Zero())[0], 1.2, 1e-12);
  EXPECT_NEAR(drives.Step(ValveVector::Constant(1.3), ValveVector::Zero())[0], 1.2, 1e-12);
}

TEST(PneumaticsTest, ALeakLowersTheSteadyPressure) {
  PneumaticParameters p;
  p.leakage = 2;
  PneumaticDrives drives(p, kDt, RandomEngine(1));
  // 0 = (u - p) / T - L p  =>  p = u / (1 + T L)
  const ValveVector pressure = Fill(drives, ValveVector::Constant(3), ValveVector::Zero(), 2);
  EXPECT_NEAR(pressure[0], 3 / (1 + 0.1 * 2), 1e-6);
}

TEST(PneumaticsTest, AValveFillsNoFasterThanItsRate) {
  PneumaticParameters p;
  p.max_rate = 8;
  PneumaticDrives drives(p, kDt, RandomEngine(1));
  const ValveVector early = Fill(drives, ValveVector::Constant(5), ValveVector::Zero(), 0.2);
  EXPECT_NEAR(early[0], 1.6, 1e-9);
  EXPECT_NEAR(Fill(drives, ValveVector::Constant(5), early, 2)[0], 5, 1e-3);
}

TEST(PneumaticsTest, SensorNoiseHasTheAskedDeviationAndTheSeedRepeatsIt) {
  PneumaticParameters p;
  p.pressure_noise = 0.05;
  p.angle_noise = 0.01;
  const auto readings = [&](std::uint64_t seed) {
    PneumaticDrives drives(p, kDt, MakeStream(seed, 0, "actuation"));
    Eigen::VectorXd all(19 * 500);
    for (int i = 0; i < 500; ++i) {
      RobotState state;
      state.hand_q = HandVector::Zero(11);
      drives.Sense(state);
      all.segment<8>(19 * i) = state.pressure / p.pressure_noise;
      all.segment<11>(19 * i + 8) = state.hand_q / p.angle_noise;
    }
    return all;
  };
  const Eigen::VectorXd first = readings(5);
  EXPECT_NEAR(first.mean(), 0, 4 / std::sqrt(first.size()));
  EXPECT_NEAR(first.squaredNorm() / static_cast<double>(first.size()), 1, 0.06);
  EXPECT_EQ(first, readings(5));
  EXPECT_NE(first, readings(6));
}

TEST(PneumaticsTest, SceneParametersReachTheModelInTheirUnits) {
  Scene scene = ParseScene(
      "active: [right_hand]\n"
      "pneumatics: {fill_time: 0.05, supply: 6, area: 1.5, lever: 0.8, spring: 0.1,\n"
      "             damping: 0.03, friction: 0.01, leakage: 1}\n",
      "scene.yaml");
  const ModelPtr m = BuildModel(scene);
  for (const std::string& valve : ValvesOf(*m)) {
    const int a = IdOf(*m, mjOBJ_ACTUATOR, valve);
    EXPECT_EQ(m->actuator_dynprm[mjNDYN * a], 0.05) << valve;
    EXPECT_EQ(m->actuator_ctrlrange[2 * a + 1], 6) << valve;
    // 1e5 Pa/bar x 1.5e-4 m^2 x 0.8e-2 m
    EXPECT_NEAR(m->actuator_gear[6 * a], valve == "hand_r_palm" ? 0.24 : 0.12, 1e-12) << valve;
  }
  const int index = IdOf(*m, mjOBJ_JOINT, "hand_r_index_j0");
  const int palm = IdOf(*m, mjOBJ_JOINT, "hand_r_palm");
  EXPECT_EQ(m->jnt_stiffness[index], 0.1);
  EXPECT_EQ(m->jnt_stiffness[palm], 0.2);
  EXPECT_EQ(m->dof_damping[m->jnt_dofadr[index]], 0.03);
  EXPECT_EQ(m->dof_frictionloss[m->jnt_dofadr[index]], 0.01);
  EXPECT_EQ(m->dof_frictionloss[m->jnt_dofadr[palm]], 0.02);
  const DriveStep step = MeasureDriveStep(*m, "hand_r_index_distal", 1);
  EXPECT_NEAR(step.time_constant, 0.05, 0.003);
}

TEST(PneumaticsTest, ValuesOutOfRangeNameKeyAndLine) {
  try {
    ParseScene("pneumatics:\n  leakage: -1\n", "scene.yaml");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("scene.yaml:2"));
    EXPECT_THAT(e.what(), ::testing::HasSubstr("leakage"));
  }
  EXPECT_THROW(ParseScene("pneumatics: {pressure: 3}\n", "scene.yaml"), Error);
}

}  // namespace
}  // namespace springgrasp
