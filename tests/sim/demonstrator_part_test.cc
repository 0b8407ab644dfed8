#include "sim/demonstrator_part.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "base/error.h"
#include "base/fingers.h"
#include "sim/model_index.h"
#include "sim/scene_builder.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class DemonstratorPartTest : public testing::TestWithParam<const char*> {
 protected:
  static ModelPtr Hand(const SceneDemonstrator& who = {}) {
    Scene scene;
    scene.source = "scene.yaml";
    scene.demonstrator = who;
    BuildOptions options;
    options.with_robot = options.with_table = false;
    options.with_demonstrator = true;
    options.demonstrator_model = GetParam();
    return BuildModel(scene, options);
  }
};

INSTANTIATE_TEST_SUITE_P(Hands, DemonstratorPartTest,
                         testing::Values("mmm_hand/mmm_hand_r.xml", "mmm_hand/mmm_hand_l.xml"),
                         [](const auto& hand) { return hand.index == 0 ? "Right" : "Left"; });

int CapOf(const mjModel& m, int finger) {
  return IdOf(m, mjOBJ_GEOM, "mmm_" + std::string(kFingerNames[finger]) + "_cap");
}
int TipOf(const mjModel& m, int finger) {
  return IdOf(m, mjOBJ_SITE, "mmm_" + std::string(kFingerNames[finger]) + "_tip");
}

SceneDemonstrator OfLength(double length) {
  SceneDemonstrator who;
  who.hand_length = length;
  return who;
}

TEST_P(DemonstratorPartTest, TipsAndMassesFollowTheHandLength) {
  const ModelPtr common = Hand();
  for (const double length : {0.15, 0.165, 0.205}) {
    const double s = length / 0.189;
    const ModelPtr m = Hand(OfLength(length));
    Simulation a(Hand()), b(Hand(OfLength(length)));
    a.SetJoint("mmm_index_mcp", 0.7);
    b.SetJoint("mmm_index_mcp", 0.7);
    a.Forward();
    b.Forward();
    for (int i = 0; i < 3 * m->nsite; ++i) {
      EXPECT_NEAR(b.data().site_xpos[i], s * a.data().site_xpos[i], 1e-12);
    }
    for (int i = 1; i < m->nbody; ++i) {
      EXPECT_NEAR(m->body_mass[i], s * s * s * common->body_mass[i], 1e-12);
    }
  }
}

TEST_P(DemonstratorPartTest, CapsStayCentredAndAddTheSameToABiggerPad) {
  const ModelPtr common = Hand();
  for (const double length : {0.15, 0.205}) {
    Simulation sim(Hand(OfLength(length)));
    sim.Forward();
    const mjModel& m = sim.model();
    for (int f = 0; f < kNumFingers; ++f) {
      const int cap = CapOf(m, f), tip = TipOf(m, f);
      const double extra =
          common->geom_size[3 * CapOf(*common, f)] - common->site_size[3 * TipOf(*common, f)];
      EXPECT_NEAR(m.geom_size[3 * cap] - m.site_size[3 * tip], extra, 1e-12);
      EXPECT_NEAR(m.geom_size[3 * cap + 1], common->geom_size[3 * CapOf(*common, f) + 1], 1e-12)
          << "straight part";
      EXPECT_LT((Vector3From(sim.data().geom_xpos + 3 * cap) -
                 Vector3From(sim.data().site_xpos + 3 * tip))
                    .norm(),
                1e-12);
    }
  }
}

TEST_P(DemonstratorPartTest, GivenDiameterHoldsForAllCaps) {
  for (const double length : {0.165, 0.189}) {
    SceneDemonstrator who = OfLength(length);
    who.cap_diameter = 0.024;
    const ModelPtr m = Hand(who);
    for (int f = 0; f < kNumFingers; ++f) {
      EXPECT_EQ(m->geom_size[3 * CapOf(*m, f)], 0.012);
      EXPECT_LT(m->site_size[3 * TipOf(*m, f)], 0.009) << "the pad stays";
    }
  }
}

TEST_P(DemonstratorPartTest, CapThatDoesNotCoverItsPadIsAnError) {
  SceneDemonstrator who;
  who.cap_diameter = 0.016;
  try {
    Hand(who);
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr("scene.yaml"), HasSubstr("cap_diameter is 0.016 m"),
                                HasSubstr("more than 0.0170 m to cover mmm_index_tip")));
  }
  who.hand_length = 0.165;  // a child's pads are smaller
  EXPECT_NO_THROW(Hand(who));
}

TEST_P(DemonstratorPartTest, ColoursGoToCapsAndSkin) {
  SceneDemonstrator who;
  who.cap_colour = Eigen::Vector3d(0.1, 0.2, 0.9);
  who.skin_colour = Eigen::Vector3d(0.4, 0.3, 0.25);
  const ModelPtr m = Hand(who);
  const auto colour_of = [&](const char* geom) {
    const int material = m->geom_matid[IdOf(*m, mjOBJ_GEOM, geom)];
    return Eigen::Vector3d(
        Eigen::Map<const Eigen::Vector3f>(m->mat_rgba + 4 * material).cast<double>());
  };
  EXPECT_LT((colour_of("mmm_ring_cap") - *who.cap_colour).norm(), 1e-6);
  EXPECT_LT((colour_of("mmm_heel") - *who.skin_colour).norm(), 1e-6);
}

TEST(DemonstratorPart, FileWithoutItsHandLengthIsAnError) {
  const std::string path = testing::TempDir() + "/hand_without_length.xml";
  std::ofstream(path) << "<mujoco><compiler angle='radian'/><worldbody><body name='mmm_hand'>"
                         "<geom size='0.01'/></body></worldbody></mujoco>";
  try {
    ReadDemonstratorPart(path, Scene{});
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), AllOf(HasSubstr(path), HasSubstr("mmm_hand_length")));
  }
}

}  // namespace
}  // namespace springgrasp
