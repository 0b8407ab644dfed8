// The pneumatic hands of the robot model: both sides, as documented and with the opposition joint.
#include <Eigen/LU>
#include <cmath>
#include <map>
#include <vector>

#include "files/model_file.h"
#include "sim/measure_drives.h"

namespace springgrasp {
namespace {

const std::vector<std::string> kFingers = {"thumb", "index", "middle", "ring", "pinkie"};
using Valves = std::map<std::string, std::vector<std::string>>;

struct Hand {
  std::string variant, side;
  ModelFile robot() const { return ModelFile(ModelPath("armar3b/armar3b" + variant + ".xml")); }
  std::string name() const { return "hand_" + side; }
  // Joints of every valve, without the hand's name.
  Valves valves() const {
    Valves v = {{"palm", {"palm"}},
                {"index_proximal", {"index_j0"}},
                {"index_distal", {"index_j1"}},
                {"middle_proximal", {"middle_j0"}},
                {"middle_distal", {"middle_j1"}},
                {"ring_pinkie", {"ring_j0", "ring_j1", "pinkie_j0", "pinkie_j1"}}};
    if (variant.empty()) {
      v["thumb_proximal"] = {"thumb_j0"};
      v["thumb_distal"] = {"thumb_j1"};
    } else {
      v["thumb_opposition"] = {"thumb_opposition"};
      v["thumb_flexion"] = {"thumb_j0", "thumb_j1"};
    }
    return v;
  }
};

class Armar3bHand : public ::testing::TestWithParam<Hand> {};
INSTANTIATE_TEST_SUITE_P(Hands, Armar3bHand,
                         ::testing::Values(Hand{"", "r"}, Hand{"", "l"}, Hand{"_opposition", "r"},
                                           Hand{"_opposition", "l"}),
                         [](const auto& hand) {
                           return (hand.param.side == "r" ? "right" : "left") + hand.param.variant;
                         });

TEST_P(Armar3bHand, HandFrameLooksToTheMiddleKnuckleWithItsBackUp) {
  const std::string hand = GetParam().name();
  const ModelFile robot = GetParam().robot();
  const Eigen::Matrix3d H = robot.SiteAxes(hand + "_H");
  const Eigen::Vector3d origin = robot.Site(hand + "_H");
  const Eigen::Vector3d knuckle = robot.Body(hand + "_middle_j0") - origin;
  EXPECT_LT((origin - robot.Body(hand)).norm(), 1e-9);
  EXPECT_LT((H.col(0) - knuckle.normalized()).norm(), 1e-6);
  EXPECT_GT(H.col(2).dot(robot.BodyAxes(hand).col(0)), 0.99);
  EXPECT_NEAR(H.determinant(), 1, 1e-9);
  // y = z cross x points to the thumb's side on a right hand, away from it on a left one.
  const double across =
      H.col(1).dot(robot.Body(hand + "_index_j0") - robot.Body(hand + "_pinkie_j0"));
  EXPECT_NEAR(across, GetParam().side == "r" ? 0.073 : -0.073, 1e-3);
  EXPECT_LT(H.col(2).dot(robot.Site(hand + "_thumb_tip") - origin), 0.0);
}

TEST_P(Armar3bHand, TipSitesAreTheCentresOfTheEndSpheresAndPadsLieOnThem) {
  const ModelFile robot = GetParam().robot();
  for (const std::string& finger : kFingers) {
    const std::string name = GetParam().name() + "_" + finger;
    const double* size = robot.m()->geom_size + 3 * robot.Id(mjOBJ_GEOM, name + "_j1_capsule");
    const Eigen::Vector3d offset = robot.Site(name + "_tip") - robot.Geom(name + "_j1_capsule");
    EXPECT_NEAR(size[0], 0.0093, 1e-9);
    EXPECT_NEAR(std::abs(offset.dot(robot.GeomAxes(name + "_j1_capsule").col(2))), size[1], 1e-8);
    EXPECT_NEAR(offset.norm(), size[1], 1e-8) << finger;
    EXPECT_GT(offset.dot(robot.Site(name + "_tip") - robot.Body(name + "_j1")), 0);
    // The pad's z points out of the skin, to the side that flexion moves to.
    const Eigen::Vector3d out = robot.Site(name + "_pad") - robot.Site(name + "_tip");
    EXPECT_LT((out - size[0] * robot.SiteAxes(name + "_pad").col(2)).norm(), 1e-8) << finger;
    ModelFile bent = GetParam().robot();
    bent.Angle(name + "_j1") = 0.1;
    mj_kinematics(bent.m(), bent.d());
    EXPECT_GT((bent.Site(name + "_tip") - robot.Site(name + "_tip")).dot(out), 0) << finger;
  }
}

TEST_P(Armar3bHand, EightValvesDriveTheJoints) {
  const ModelFile robot = GetParam().robot();
  const mjModel& m = *robot.m();
  int valves = 0, joints = 0;
  for (int i = 0; i < m.nu; ++i) {
    valves += robot.Name(mjOBJ_ACTUATOR, i).rfind(GetParam().name(), 0) == 0;
  }
  EXPECT_EQ(valves, 8);
  for (const auto& [valve, driven] : GetParam().valves()) {
    const int i = robot.Id(mjOBJ_ACTUATOR, GetParam().name() + "_" + valve);
    EXPECT_EQ(m.actuator_ctrlrange[2 * i], 0.0) << valve;
    EXPECT_EQ(m.actuator_ctrlrange[2 * i + 1], 5.0) << valve;
    EXPECT_EQ(m.actuator_dynprm[mjNDYN * i], 0.1) << valve;
    EXPECT_NEAR(m.actuator_gear[6 * i], valve == "palm" ? 0.2 : 0.1, 1e-12) << valve;
    joints += static_cast<int>(driven.size());
  }
  EXPECT_EQ(joints, GetParam().variant.empty() ? 11 : 12);
}

TEST_P(Armar3bHand, PressureSensorsReadTheChambersInBar) {
  ModelFile robot = GetParam().robot();
  for (const auto& [valve, joints] : GetParam().valves()) {
    robot.d()->ctrl[robot.Id(mjOBJ_ACTUATOR, GetParam().name() + "_" + valve)] = 1.5;
  }
  for (int i = 0; i < 50; ++i) mj_step(robot.m(), robot.d());
  mj_forward(robot.m(), robot.d());
  for (const auto& [valve, joints] : GetParam().valves()) {
    const int sensor = robot.Id(mjOBJ_SENSOR, GetParam().name() + "_" + valve + "_pressure");
    EXPECT_NEAR(robot.d()->sensordata[robot.m()->sensor_adr[sensor]], 1.5 * (1 - std::exp(-1.0)),
                0.02)
        << valve;
  }
}

TEST_P(Armar3bHand, StepResponseHasTheDocumentedTimeConstantAndSteadyAngle) {
  const ModelFile robot = GetParam().robot();
  for (const auto& [valve, joints] : GetParam().valves()) {
    SCOPED_TRACE(valve);
    const std::string name = GetParam().name() + "_" + valve;
    const DriveStep step = MeasureDriveStep(*robot.m(), name, MidPressure(*robot.m(), name));
    EXPECT_NEAR(step.time_constant, 0.1, 0.005);
    ASSERT_EQ(step.joints.size(), joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i) {
      EXPECT_EQ(step.joints[i], GetParam().name() + "_" + joints[i]);
      // Spring and chamber balance in the middle of the range; 5 % of the way from the spring's
      // rest.
      const double lower = joints[i] == "thumb_opposition" ? -0.523599 : 0;
      const double upper = joints[i] == "palm"               ? 0.698132
                           : joints[i] == "thumb_opposition" ? 1.745329
                                                             : 1.570796;
      const double documented = (lower + upper) / 2;
      EXPECT_NEAR(step.balance[i], documented, 1e-5);
      EXPECT_NEAR(step.steady[i], documented, 0.05 * (documented - lower + 0.2)) << joints[i];
    }
  }
}

TEST_P(Armar3bHand, FullPressureClosesEveryJointTowardsThePalmAndTheSpringsOpenIt) {
  for (const auto& [valve, joints] : GetParam().valves()) {
    SCOPED_TRACE(valve);
    ModelFile robot = GetParam().robot();
    for (double& g : robot.m()->opt.gravity) g = 0.0;
    for (int i = 0; i < robot.m()->nv; ++i) {
      const std::string joint = robot.Name(mjOBJ_JOINT, robot.m()->dof_jntid[i]);
      if (joint.rfind("hand_", 0) != 0) robot.m()->dof_damping[i] = 1e4;
    }
    const std::string hand = GetParam().name();
    const int control = robot.Id(mjOBJ_ACTUATOR, hand + "_" + valve);
    robot.d()->ctrl[control] = 5.0;
    while (robot.d()->time < 1.5) mj_step(robot.m(), robot.d());
    for (const std::string& joint : joints) {
      // With all joints of a finger bent, its tip ends at the palm, before the stops.
      const double share = joints.size() > 1 ? 0.7 : 0.95;
      EXPECT_GT(robot.Angle(hand + "_" + joint), share * robot.UpperLimit(hand + "_" + joint))
          << joint;
    }
    robot.d()->ctrl[control] = 0.0;
    while (robot.d()->time < 4.0) mj_step(robot.m(), robot.d());
    for (const std::string& joint : joints) {
      const double lower = robot.m()->jnt_range[2 * robot.Id(mjOBJ_JOINT, hand + "_" + joint)];
      EXPECT_LT(robot.Angle(hand + "_" + joint), lower + 0.02) << joint;
    }
    EXPECT_EQ(robot.NumWarnings(), 0);
  }
}

TEST(Armar3bPads, BlockedForceGrowsWithPressureToSomeNewtons) {
  const ModelFile robot = Hand{"", "r"}.robot();
  for (const std::string& finger : kFingers) {
    const double half = MeasurePadForce(*robot.m(), "hand_r", finger, 0.5, 2.5);
    const double full = MeasurePadForce(*robot.m(), "hand_r", finger, 0.5, 5.0);
    EXPECT_GT(half, 1) << finger;
    EXPECT_GT(full, 1.8 * half) << finger;
    EXPECT_LT(full, 15) << finger;
  }
}

// The public thumb moves between index and middle; only the variant's comes beside the index.
TEST(Armar3bThumb, OnlyTheOppositionJointBringsItBesideTheIndex) {
  const auto beside_index = [](const std::string& variant) {
    ModelFile robot = Hand{variant, "r"}.robot();
    double most = -1;
    for (double turn = 0; turn <= 1.7; turn += 0.1) {
      if (!variant.empty()) robot.Angle("hand_r_thumb_opposition") = turn;
      for (double bend = 0; bend <= 1.5; bend += 0.1) {
        robot.Angle("hand_r_thumb_j0") = robot.Angle("hand_r_thumb_j1") = bend;
        mj_kinematics(robot.m(), robot.d());
        const Eigen::Vector3d from_index =
            robot.Site("hand_r_thumb_tip") - robot.Body("hand_r_index_j0");
        most = std::max(most, -robot.BodyAxes("hand_r").col(1).dot(from_index));
      }
    }
    return most;
  };
  EXPECT_NEAR(beside_index(""), -0.0135, 1e-6);
  EXPECT_GT(beside_index("_opposition"), 0.02);
}

}  // namespace
}  // namespace springgrasp
