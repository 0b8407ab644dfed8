#include "sim/kinematic_tree_of.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/random.h"
#include "sim/model_index.h"
#include "sim/sim_fixture.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

// Largest difference between the tree's frames and MuJoCo's sites, in metres and matrix entries.
double WorstDifference(const mjModel& m, const mjData& d, const KinematicTree& tree,
                       const std::string& root) {
  std::vector<Pose> X_RB;
  ForwardKinematics(tree, JointPositions(tree, m, d), X_RB);
  const Pose X_RW = BodyPose(m, d, root).inverse();
  double worst = 0;
  for (int f = 0; f < static_cast<int>(tree.frames.size()); ++f) {
    const Pose expected = X_RW * SitePose(m, d, tree.frames[f].name);
    const Pose found = FramePose(tree, X_RB, f);
    worst = std::max(worst, (expected.matrix() - found.matrix()).cwiseAbs().maxCoeff());
  }
  return worst;
}

void Randomise(const mjModel& m, mjData& d, RandomEngine& engine) {
  for (int j = 0; j < m.njnt; ++j) {
    if (m.jnt_type[j] == mjJNT_FREE) continue;
    const double lower = m.jnt_limited[j] ? m.jnt_range[2 * j] : -3;
    const double upper = m.jnt_limited[j] ? m.jnt_range[2 * j + 1] : 3;
    d.qpos[m.jnt_qposadr[j]] = Uniform(engine, lower, upper);
  }
  mj_kinematics(&m, &d);
}

TEST(KinematicTreeOfTest, AgreesWithMujocoOnRandomPostures) {
  Scene scene = TestScene();
  scene.active = {"head", "right_arm", "right_hand"};
  scene.torso = "free";
  const ModelPtr m = BuildModel(scene, TestDemonstrator());
  const DataPtr d = MakeData(*m);
  const std::vector<std::pair<std::string, std::vector<std::string>>> cases = {
      {"world", {}},
      {"world", {"hand_r_H"}},
      {"hand_r_base", {}},
      {"hand_r_base", {"hand_r_index_tip", "hand_r_thumb_j1"}},
      {"mmm_hand", {}}};
  RandomEngine engine = MakeStream(11, 0, "tree");
  for (const auto& [root, leaves] : cases) {
    const KinematicTree tree = KinematicTreeOf(*m, root, leaves);
    EXPECT_FALSE(tree.frames.empty());
    for (int k = 0; k < 20; ++k) {
      Randomise(*m, *d, engine);
      EXPECT_LT(WorstDifference(*m, *d, tree, root), 1e-9) << root;
    }
  }
}

TEST(KinematicTreeOfTest, AnchorsReferencesAndSeveralJointsAreKept) {
  const ModelPtr m = LoadModelText(R"(
    <mujoco><compiler angle="radian" autolimits="true"/><worldbody>
      <body name="a" pos="0.1 0 0.2" quat="0.8 0.6 0 0">
        <joint name="s" type="slide" axis="1 1 0" ref="0.05" range="-0.1 0.2"/>
        <joint name="h" axis="0 1 0" pos="0.02 0 -0.03" ref="0.4"/>
        <joint name="g" axis="0 0 1" pos="0 0.01 0"/>
        <geom size="0.01"/>
        <body name="b" pos="0 0.1 0"><joint name="k" axis="1 2 3" pos="0.01 0.02 0.03"/>
          <geom size="0.01"/><site name="tip" pos="0.1 0.2 0.3" quat="0.6 0 0.8 0"/></body>
      </body></worldbody></mujoco>)",
                                   "test");
  const DataPtr d = MakeData(*m);
  const KinematicTree tree = KinematicTreeOf(*m, "world");
  EXPECT_EQ(tree.num_joints(), 4);
  EXPECT_EQ(tree.lower[0], -0.1);
  EXPECT_NEAR(tree.upper[1], mjPI, 1e-12);
  RandomEngine engine = MakeStream(12, 0, "tree");
  for (int k = 0; k < 50; ++k) {
    Randomise(*m, *d, engine);
    EXPECT_LT(WorstDifference(*m, *d, tree, "world"), 1e-9);
  }
}

TEST(KinematicTreeOfTest, LeavesKeepOnlyTheirPath) {
  const ModelPtr m = BuildModel(TestScene());
  const KinematicTree arm = KinematicTreeOf(*m, "world", {"hand_r_H"});
  EXPECT_EQ(arm.num_joints(), 7);
  EXPECT_EQ(arm.joint_names.front(), "arm_r_shoulder1");
  EXPECT_EQ(arm.joint_names.back(), "arm_r_wrist2");
  EXPECT_EQ(KinematicTreeOf(*m, "hand_r_base").num_joints(), 11);
  EXPECT_THROW(KinematicTreeOf(*m, "world", {"can"}), Error);
  EXPECT_THROW(KinematicTreeOf(*m, "world", {"nothing"}), Error);
}

}  // namespace
}  // namespace springgrasp
