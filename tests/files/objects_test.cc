// Every object of models/objects: one sound body that looks as it feels, and lies where it is put.
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "sim/model_index.h"
#include "sim/object_file.h"
#include "sim/scene_builder.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr int kLooks = 2, kSolid = 3;  // geom groups

std::vector<std::string> ObjectFiles() {
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(ModelPath("objects"))) {
    if (entry.path().extension() == ".xml") paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

class Objects : public ::testing::TestWithParam<std::string> {
 protected:
  std::string path() const { return GetParam(); }
  std::string name() const { return fs::path(path()).stem(); }

  // The object alone on a table; round ones on their ring.
  Scene OnTable() const {
    Scene scene = ParseScene(
        fmt::format("objects: [{{name: {}, model: '{}', pose: [0.3, 0.6]}}]", name(), path()),
        "object.yaml");
    SceneObject& object = scene.objects[0];
    object.on_ring = SeatOnRing(object).has_value();
    return scene;
  }
};

// After a second it is still, and stays so; it stands where `rest` says.
void ExpectRest(Simulation& sim, const std::string& name, const Pose& rest) {
  const int body = IdOf(sim.model(), mjOBJ_BODY, name);
  while (sim.time() < 1 && !sim.diverged()) sim.Step();
  double speed = 0, spin = 0;
  while (sim.time() < 2 && !sim.diverged()) {
    sim.Step();
    const BodyState state = ReadBodyState(sim.model(), sim.data(), body);
    speed = std::max(speed, state.v_WC.norm());
    spin = std::max(spin, state.w_WB.norm());
  }
  ASSERT_FALSE(sim.diverged()) << sim.diverged()->warning;
  for (const mjWarningStat& warning : sim.data().warning) EXPECT_EQ(warning.number, 0);
  EXPECT_LT(speed, 0.002);  // m/s
  EXPECT_LT(spin, 0.05);    // rad/s
  const Pose X_WO = ReadBodyState(sim.model(), sim.data(), body).X_WB;
  EXPECT_LT((X_WO.translation() - rest.translation()).norm(), 0.005);
  const double tilt = std::acos(std::min(1.0, X_WO.linear().col(2).dot(rest.linear().col(2))));
  EXPECT_LT(tilt, 3 * M_PI / 180);
}

BuildOptions WithoutRobot() {
  BuildOptions options;
  options.with_robot = false;
  return options;
}

TEST(ObjectsFolder, HoldsADozenObjects) { EXPECT_GE(ObjectFiles().size(), 12u); }

TEST_P(Objects, IsOneBodyNamedLikeItsFile) {
  const ModelPtr m = LoadModelFile(path());
  EXPECT_EQ(m->nbody, 2);
  EXPECT_EQ(NameOf(*m, mjOBJ_BODY, 1), name());
  ASSERT_EQ(m->njnt, 1);
  EXPECT_EQ(m->jnt_type[0], mjJNT_FREE);
}

TEST_P(Objects, MassIsTheSumOfItsParts) {
  tinyxml2::XMLDocument document;
  ASSERT_EQ(document.LoadFile(path().c_str()), tinyxml2::XML_SUCCESS);
  const auto* body =
      document.FirstChildElement("mujoco")->FirstChildElement("worldbody")->FirstChildElement();
  double sum = 0;
  for (const auto* g = body->FirstChildElement("geom"); g; g = g->NextSiblingElement("geom")) {
    if (std::string(g->Attribute("class")) == "collision") {
      EXPECT_GT(g->DoubleAttribute("mass"), 0);
    }
    sum += g->DoubleAttribute("mass");
  }
  const ModelPtr m = LoadModelFile(path());
  EXPECT_NEAR(m->body_mass[1], sum, 1e-6 + 1e-6 * sum);
}

TEST_P(Objects, SizesCentreAndInertiaAreThoseOfSomethingInTheHand) {
  const ObjectFile file = ReadObjectFile(path());
  const ModelPtr m = LoadModelFile(path());
  const Vector3d centre_of_mass = Vector3From(m->body_ipos + 3);
  Vector3d extent;
  for (int k = 0; k < 3; ++k) {
    const double above = ReachOf(file.parts, Vector3d::Unit(k));
    const double below = ReachOf(file.parts, -Vector3d::Unit(k));
    extent[k] = above + below;
    EXPECT_GT(extent[k], 0.0005) << k;
    EXPECT_LT(extent[k], 0.4) << k;
    EXPECT_LT(std::abs(above - below) / 2, 0.15 * extent[k]) << "origin off the middle along " << k;
    EXPECT_LT(centre_of_mass[k], above) << k;
    EXPECT_GT(centre_of_mass[k], -below) << k;
  }
  // No mass lies outside, so no radius of gyration is longer than the box's half diagonal.
  const double* inertia = m->body_inertia + 3;
  for (int k = 0; k < 3; ++k) {
    EXPECT_GT(inertia[k], 0) << k;
    EXPECT_LT(std::sqrt(inertia[k] / m->body_mass[1]), extent.norm() / 2) << k;
    EXPECT_LE(inertia[k], inertia[(k + 1) % 3] + inertia[(k + 2) % 3] + 1e-12) << k;
  }
}

TEST_P(Objects, LooksAreIntangibleAndSolidPartsAreNot) {
  const ModelPtr m = LoadModelFile(path());
  for (int g = 0; g < m->ngeom; ++g) {
    ASSERT_TRUE(m->geom_group[g] == kLooks || m->geom_group[g] == kSolid) << g;
    EXPECT_EQ((m->geom_contype[g] | m->geom_conaffinity[g]) != 0, m->geom_group[g] == kSolid) << g;
  }
}

// Distance along a ray to the geoms of a group, m; -1 without a hit.
double RayTo(const mjModel& m, const mjData& d, int group, const Vector3d& from,
             const Vector3d& direction) {
  mjtByte groups[mjNGROUP] = {};
  groups[group] = 1;
  int geom = -1;
  return mj_ray(&m, &d, from.data(), direction.data(), groups, 1, -1, &geom);
}

TEST_P(Objects, LooksLieWithinMillimetresOfTheSolidParts) {
  const ObjectFile file = ReadObjectFile(path());
  const ModelPtr m = LoadModelFile(path());
  const DataPtr d = MakeData(*m);
  mj_forward(m.get(), d.get());
  const double above = ReachOf(file.parts, Vector3d::UnitZ());
  const double below = ReachOf(file.parts, -Vector3d::UnitZ());
  constexpr int kSides = 12;
  constexpr double kFar = 0.5, kTolerance = 0.004;  // m; teeth of the key, flesh between lobes
  int hits = 0;
  for (const double height : {0.2, 0.35, 0.5, 0.65, 0.8}) {
    for (int side = 0; side < kSides; ++side) {
      const double angle = 2 * M_PI * side / kSides;
      const Vector3d direction(std::cos(angle), std::sin(angle), 0);
      const Vector3d from = Vector3d(0, 0, height * (above + below) - below) - kFar * direction;
      const double looks = RayTo(*m, *d, kLooks, from, direction);
      const double solid = RayTo(*m, *d, kSolid, from, direction);
      EXPECT_NEAR(looks, solid, kTolerance) << "height " << height << ", angle " << angle;
      hits += solid > 0;
    }
  }
  EXPECT_GT(hits, 2 * kSides);
}

TEST_P(Objects, StaysWhereItIsPut) {
  const Scene scene = OnTable();
  Simulation sim(BuildModel(scene, WithoutRobot()));
  ExpectRest(sim, name(), ObjectStartPose(scene, 0));
}

TEST_P(Objects, ComesToRestAfterAFallOfTwoCentimetres) {
  const Scene scene = OnTable();
  const Pose rest = ObjectStartPose(scene, 0);
  Simulation sim(BuildModel(scene, WithoutRobot()));
  Pose above = rest;
  above.translation().z() += 0.02;
  sim.PlaceBody(name(), above);
  sim.Forward();
  ExpectRest(sim, name(), rest);
}

INSTANTIATE_TEST_SUITE_P(All, Objects, ::testing::ValuesIn(ObjectFiles()),
                         [](const auto& test) { return fs::path(test.param).stem().string(); });

}  // namespace
}  // namespace springgrasp
