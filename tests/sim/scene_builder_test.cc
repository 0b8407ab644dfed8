#include "sim/scene_builder.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/random.h"
#include "sim/describe_model.h"
#include "sim/display_furniture.h"
#include "sim/model_index.h"
#include "sim/sim_fixture.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(SceneBuilderTest, ModelHasRobotTableObjectsAndCameras) {
  const ModelPtr m = BuildModel(TestScene());
  EXPECT_EQ(m->nq, 18 + 3 * 7);
  EXPECT_EQ(m->nu, 15);
  EXPECT_EQ(m->na, 8);
  for (const char* body : {"table", "ball", "can", "block", "ball_ring", "hand_r_index_j1"}) {
    EXPECT_GE(FindId(*m, mjOBJ_BODY, body), 0) << body;
  }
  for (const char* camera : {"front", "eye_l_wide", "eye_r_wide"}) {
    EXPECT_GE(FindId(*m, mjOBJ_CAMERA, camera), 0) << camera;
  }
  EXPECT_GE(FindId(*m, mjOBJ_JOINT, "ball_free"), 0);
  EXPECT_LT(FindId(*m, mjOBJ_JOINT, "torso_yaw"), 0);
  EXPECT_EQ(m->nsensor, 1);
  EXPECT_THAT(DescribeModel(*m), HasSubstr("arm_r_elbow"));
}

TEST(SceneBuilderTest, SameSceneGivesTheSameText) {
  EXPECT_EQ(BuildMjcf(TestScene()), BuildMjcf(TestScene()));
}

TEST(SceneBuilderTest, FrozenJointsStandWhereTheyStarted) {
  // Reference: the whole robot with all joints, put at the start posture.
  Scene scene = TestScene();
  const ModelPtr whole = LoadModelFile(scene.robot);
  const DataPtr d = MakeData(*whole);
  RandomEngine engine = MakeStream(1, 0, "frozen");
  for (int k = 0; k < 5; ++k) {
    for (int j = 0; j < whole->njnt; ++j) {
      const double q = Uniform(engine, whole->jnt_range[2 * j], whole->jnt_range[2 * j + 1]);
      d->qpos[whole->jnt_qposadr[j]] = q;
      scene.start[NameOf(*whole, mjOBJ_JOINT, j)] = q;
    }
    mj_kinematics(whole.get(), d.get());
    for (const std::vector<std::string>& active :
         {std::vector<std::string>{}, {"right_hand"}, {"head", "right_arm", "right_hand"}}) {
      scene.active = active;
      Simulation sim(BuildModel(scene));
      for (int b = 1; b < whole->nbody; ++b) {
        const std::string name = NameOf(*whole, mjOBJ_BODY, b);
        const Pose X = BodyPose(sim.model(), sim.data(), name);
        EXPECT_TRUE(X.isApprox(BodyPose(*whole, *d, name), 1e-9)) << name;
      }
    }
  }
}

TEST(SceneBuilderTest, FreezingKeepsMassAndDropsWhatActedOnTheJoints) {
  Scene scene = TestScene();
  scene.objects.clear();
  const ModelPtr active = BuildModel(scene);
  scene.active.clear();
  const ModelPtr frozen = BuildModel(scene);
  EXPECT_EQ(frozen->njnt, 0);
  EXPECT_EQ(frozen->nu, 0);
  EXPECT_EQ(frozen->ntendon, 0);
  EXPECT_EQ(frozen->nsensor, 0);
  EXPECT_NEAR(frozen->body_subtreemass[0], active->body_subtreemass[0], 1e-9);
}

TEST(SceneBuilderTest, ShoulderDoesNotCollideWithTheFixedTorso) {
  // The shoulder's capsule reaches into the torso: neighbours, exempt while both moved.
  Scene scene = TestScene();
  scene.objects.clear();
  Simulation sim(BuildModel(scene));
  for (int i = 0; i < sim.data().ncon; ++i) {
    const mjContact& c = sim.data().contact[i];
    ADD_FAILURE() << NameOf(sim.model(), mjOBJ_BODY, sim.model().geom_bodyid[c.geom1]) << " and "
                  << NameOf(sim.model(), mjOBJ_BODY, sim.model().geom_bodyid[c.geom2]);
  }
}

TEST(SceneBuilderTest, DemonstratorIsPlacedAndTouchesNothing) {
  BuildOptions options = TestDemonstrator();
  options.shown_object = ParseShape("box:0.03x0.03x0.05");
  Simulation sim(BuildModel(TestScene(), options));
  const Pose X_WH = MakePose({0.3, 0.6, 0.95}, Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5));
  sim.PlaceBody("mmm_hand", X_WH);
  sim.PlaceBody("shown_object", X_WH);
  sim.SetJoint("mmm_index_mcp", 0.7);
  sim.Forward();
  EXPECT_TRUE(SitePose(sim.model(), sim.data(), "mmm_H").isApprox(X_WH, 1e-12));
  const int index = IdOf(sim.model(), mjOBJ_BODY, "mmm_index_1");
  for (int i = 0; i < sim.data().ncon; ++i) {
    for (int g : {sim.data().contact[i].geom1, sim.data().contact[i].geom2}) {
      EXPECT_NE(sim.model().geom_bodyid[g], index);
      EXPECT_THAT(NameOf(sim.model(), mjOBJ_BODY, sim.model().geom_bodyid[g]),
                  Not(HasSubstr("mmm")));
    }
  }
}

TEST(SceneBuilderTest, FilesBecomeObjectsWithTheMassOfTheScene) {
  Scene scene = ParseScene(R"(
table: {height: 0.9}
objects:
  - {name: cup, model: sim_cup.xml, mass: 0.25, friction: 0.6, pose: [0.3, 0.6, 0.9]}
  - {name: wedge, model: sim_wedge.obj, mass: 0.15, friction: 0.7, pose: [0.45, 0.6, 0.92]}
)",
                           TestFile("files.yaml"));
  BuildOptions options;
  options.with_robot = false;
  Simulation sim(BuildModel(scene, options));
  const mjModel& m = sim.model();
  for (const SceneObject& object : scene.objects) {
    const int body = IdOf(m, mjOBJ_BODY, object.name);
    EXPECT_NEAR(m.body_subtreemass[body], object.mass, 1e-9) << object.name;
    EXPECT_EQ(m.geom_friction[3 * m.body_geomadr[body]], object.friction) << object.name;
    EXPECT_GE(FindId(m, mjOBJ_JOINT, object.name + "_free"), 0);
  }
  sim.Step(500);
  ASSERT_FALSE(sim.diverged());
  for (int i = 0; i < 2; ++i) {
    const Pose X = BodyPose(m, sim.data(), scene.objects[i].name);
    EXPECT_LT((X.translation() - ObjectStartPose(scene, i).translation()).norm(), 2e-3) << i;
  }
}

// Two tools from one file, the second with mass and friction of the scene.
Scene TwoTools() {
  return ParseScene(R"(
objects:
  - {name: a, model: sim_tool.xml, pose: [0.3, 0.55]}
  - {name: b, model: sim_tool.xml, pose: [0.3, 0.65], mass: 0.16, friction: 0.5}
)",
                    TestFile("tools.yaml"));
}

TEST(SceneBuilderTest, FileObjectsKeepTheirOwnContactSettings) {
  BuildOptions options;
  options.with_robot = false;
  const ModelPtr m = BuildModel(TwoTools(), options);
  const ModelPtr file = LoadModelFile(TestFile("sim_tool.xml"));
  for (const std::string part : {"grip", "rod"}) {
    const int own = IdOf(*file, mjOBJ_GEOM, part);
    const int a = IdOf(*m, mjOBJ_GEOM, "a_" + part), b = IdOf(*m, mjOBJ_GEOM, "b_" + part);
    EXPECT_EQ(m->geom_friction[3 * a], file->geom_friction[3 * own]);
    EXPECT_EQ(m->geom_friction[3 * b], 0.5);
    for (const int g : {a, b}) {
      EXPECT_EQ(m->geom_condim[g], file->geom_condim[own]);
      EXPECT_EQ(m->geom_friction[3 * g + 1], file->geom_friction[3 * own + 1]);
      EXPECT_EQ(m->geom_solref[mjNREF * g], file->geom_solref[mjNREF * own]);
      EXPECT_EQ(m->geom_solimp[mjNIMP * g], file->geom_solimp[mjNIMP * own]);
    }
  }
}

TEST(SceneBuilderTest, MassOfTheSceneScalesMassAndInertiaOfTheFile) {
  BuildOptions options;
  options.with_robot = false;
  const ModelPtr m = BuildModel(TwoTools(), options);
  const int a = IdOf(*m, mjOBJ_BODY, "a"), b = IdOf(*m, mjOBJ_BODY, "b");
  EXPECT_NEAR(m->body_mass[a], 0.08, 1e-12);
  EXPECT_NEAR(m->body_mass[b], 0.16, 1e-12);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(m->body_inertia[3 * b + k], 2 * m->body_inertia[3 * a + k], 1e-12);
    EXPECT_EQ(m->body_ipos[3 * b + k], m->body_ipos[3 * a + k]);
  }
}

TEST(SceneBuilderTest, FileObjectsTouchTheTableWithTheirOwnFrictionAndOnlyWhereTheyAreSolid) {
  BuildOptions options;
  options.with_robot = false;
  const Scene scene = TwoTools();
  Simulation sim(BuildModel(scene, options));
  sim.Step(500);
  ASSERT_FALSE(sim.diverged());
  int touching = 0;
  for (const ContactPoint& c : sim.contacts()) {
    const int tool = NameOf(sim.model(), mjOBJ_BODY, c.body1) == "table" ? c.geom2 : c.geom1;
    const std::string name = NameOf(sim.model(), mjOBJ_GEOM, tool);
    ASSERT_TRUE(name == "a_grip" || name == "b_grip") << name;
    EXPECT_EQ(c.friction, name == "a_grip" ? 0.7 : 0.5);
    ++touching;
  }
  EXPECT_GE(touching, 6);
  for (int i = 0; i < 2; ++i) {
    const Pose X = BodyPose(sim.model(), sim.data(), scene.objects[i].name);
    EXPECT_LT((X.translation() - ObjectStartPose(scene, i).translation()).norm(), 1e-3) << i;
  }
}

TEST(SceneBuilderTest, WrongStartPosturesAreErrors) {
  Scene scene = TestScene();
  scene.start = {{"arm_r_knee", 0.1}};
  EXPECT_THROW(BuildModel(scene), Error);
  scene.start = {{"arm_r_elbow", -1}};
  EXPECT_THROW(BuildModel(scene), Error);
  scene.start.clear();
  scene.robot = "nowhere.xml";
  EXPECT_THROW(BuildModel(scene), Error);
}

TEST(SceneBuilderTest, BrokenModelIsAnErrorWithItsName) {
  try {
    LoadModelText("<mujoco><worldbody><body name='a'><geom size='-1'/></body></worldbody></mujoco>",
                  "broken");
    FAIL() << "expected an error";
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("broken"));
    EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
  }
}

TEST(SceneBuilderTest, AScenesHandVariantIsTheFileBesideTheRobots) {
  Scene scene = ParseScene("hand: opposition\n", "scene.yaml");
  const ModelPtr m = BuildModel(scene);
  EXPECT_GE(FindId(*m, mjOBJ_JOINT, "hand_r_thumb_opposition"), 0);
  EXPECT_EQ(m->na, 8);
  scene.robot = TestFile("sim_robot.xml");  // has no such variant
  try {
    BuildModel(scene);
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("sim_robot_opposition.xml"));
  }
}

TEST(SceneBuilderTest, OnlyActiveSubsystemsMoveAndTheRestKeepsItsInertia) {
  const auto build = [](const std::string& active) {
    return BuildModel(ParseScene("active: [" + active + "]\n", "scene.yaml"));
  };
  const ModelPtr grasp = build("right_arm, right_hand");
  EXPECT_EQ(grasp->nv, 7 + 11);
  EXPECT_EQ(grasp->nu, 7 + 8);
  EXPECT_EQ(build("right_arm, right_hand, left_arm, left_hand")->nv, 2 * 18);
  EXPECT_EQ(build("head")->nv, 7);
  EXPECT_EQ(build("torso")->nv, 3);
  const ModelPtr whole = build("platform, torso, head, right_arm, right_hand, left_arm, left_hand");
  EXPECT_EQ(whole->nv, 49);
  EXPECT_EQ(whole->nu, 43);
  EXPECT_NEAR(whole->body_subtreemass[IdOf(*whole, mjOBJ_BODY, "armar3b")],
              grasp->body_subtreemass[IdOf(*grasp, mjOBJ_BODY, "armar3b")], 1e-9);
  // A torso that moves alone carries what is fixed on it with its whole inertia.
  const ModelPtr torso = build("torso");
  const DataPtr d = MakeData(*torso), all = MakeData(*whole);
  mj_resetDataKeyframe(torso.get(), d.get(), 0);
  mj_resetDataKeyframe(whole.get(), all.get(), 0);
  mj_forward(torso.get(), d.get());
  mj_forward(whole.get(), all.get());
  const auto inertia = [](const mjModel& m, const mjData& data) {
    const int dof = m.jnt_dofadr[IdOf(m, mjOBJ_JOINT, "torso_yaw")];
    return data.qM[m.dof_Madr[dof]];
  };
  // The joints' own armatures below the torso are no part of it.
  EXPECT_NEAR(inertia(*torso, *d), inertia(*whole, *all), 1e-6);
}

TEST(SceneBuilderTest, PlatesAndClutterComeWithTheDemonstratorWhereTheSceneAsks) {
  Scene scene;
  BuildOptions options;
  options.with_demonstrator = true;
  const int plain = BuildModel(scene, options)->nbody;
  scene.demonstrator.clutter = 9;
  scene.demonstrator.occlusion.fingers = {1, 2};
  const ModelPtr m = BuildModel(scene, options);
  EXPECT_EQ(m->nbody, plain + 9 + 2);
  for (const std::string& name : {OccluderName(1), OccluderName(2), ClutterName(8)}) {
    const int body = IdOf(*m, mjOBJ_BODY, name);
    EXPECT_GE(m->body_mocapid[body], 0) << name;
    EXPECT_LT(m->body_pos[3 * body + 2], -1) << "out of sight until it is placed";
    for (int g = m->body_geomadr[body]; g < m->body_geomadr[body] + m->body_geomnum[body]; ++g) {
      EXPECT_EQ(m->geom_contype[g] + m->geom_conaffinity[g], 0);
    }
  }
  EXPECT_LT(FindId(*BuildModel(scene), mjOBJ_BODY, ClutterName(0)), 0);
}

}  // namespace
}  // namespace springgrasp
