// Every scene that is shipped: it loads, stands still, and is what its file says.
#include <gmock/gmock.h>

#include <filesystem>

#include "base/files.h"
#include "base/random.h"
#include "sim/kinematic_tree_of.h"
#include "sim/model_index.h"
#include "sim/robot_io.h"
#include "sim/scene_builder.h"
#include "sim/simulation.h"

namespace springgrasp {
namespace {

std::vector<std::string> SceneFiles() {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(SourceFolder() + "/scenes")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(ShippedScenesTest, StandStillWhileTheArmIsHeld) {
  const std::vector<std::string> files = SceneFiles();
  ASSERT_FALSE(files.empty());
  for (const std::string& file : files) {
    SCOPED_TRACE(file);
    const Scene scene = ReadScene(file);
    Simulation sim(BuildModel(scene));
    const bool left = std::count(scene.active.begin(), scene.active.end(), "left_hand") > 0;
    const RobotIo io(sim.model(), left ? "l" : "r");
    const ArmVector start = io.Read(sim).arm_q;
    for (int k = 0; k < 500; ++k) {
      const RobotState state = io.Read(sim);
      RobotCommand command;
      command.arm_torque =
          state.arm_bias + state.arm_mass * (400 * (start - state.arm_q) - 40 * state.arm_qd);
      io.Write(command, sim);
      sim.Step();
    }
    ASSERT_FALSE(sim.diverged()) << sim.diverged()->warning;
    EXPECT_LT((io.Read(sim).arm_q - start).cwiseAbs().maxCoeff(), 0.02);
    for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
      const int body = IdOf(sim.model(), mjOBJ_BODY, scene.objects[i].name);
      const BodyState object = ReadBodyState(sim.model(), sim.data(), body);
      EXPECT_LT((object.X_WB.translation() - ObjectStartPose(scene, i).translation()).norm(), 1e-3);
      EXPECT_LT(object.v_WC.norm(), 2e-3);
    }
    // Nothing of the robot touches anything at the start.
    const std::vector<GeomRole> roles = ClassifyGeoms(sim.model());
    for (const ContactPoint& c : sim.contacts()) {
      for (const int g : {c.geom1, c.geom2}) {
        EXPECT_FALSE(roles[g].hand() || roles[g].part == GeomPart::kArm)
            << NameOf(sim.model(), mjOBJ_GEOM, c.geom1) << " "
            << NameOf(sim.model(), mjOBJ_GEOM, c.geom2);
      }
    }
  }
}

TEST(ShippedScenesTest, KinematicTreesAgreeWithTheEngine) {
  const Scene scene = ReadScene(SourceFolder() + "/scenes/power_cylinder.yaml");
  BuildOptions options;
  options.with_demonstrator = true;
  const ModelPtr m = BuildModel(scene, options);
  const DataPtr d = MakeData(*m);
  RandomEngine engine = MakeStream(2, 0, "trees");
  const KinematicTree arm = KinematicTreeOf(*m, "world", {"hand_r_H"});
  const KinematicTree hand = KinematicTreeOf(*m, "world", {"hand_r"});
  const KinematicTree human = KinematicTreeOf(*m, "mmm_hand");
  EXPECT_EQ(arm.num_joints(), 7);
  EXPECT_EQ(human.num_joints(), 21);
  EXPECT_GE(hand.num_joints(), 7);
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < m->njnt; ++j) {
      if (m->jnt_type[j] == mjJNT_FREE) continue;
      d->qpos[m->jnt_qposadr[j]] = Uniform(engine, m->jnt_range[2 * j], m->jnt_range[2 * j + 1]);
    }
    mj_kinematics(m.get(), d.get());
    for (const KinematicTree* tree : {&arm, &hand, &human}) {
      std::vector<Pose> X_RB;
      ForwardKinematics(*tree, JointPositions(*tree, *m, *d), X_RB);
      const Pose X_WR = tree == &human ? BodyPose(*m, *d, "mmm_hand") : Pose::Identity();
      for (int f = 0; f < static_cast<int>(tree->frames.size()); ++f) {
        const Pose expected = SitePose(*m, *d, tree->frames[f].name);
        EXPECT_TRUE((X_WR * FramePose(*tree, X_RB, f)).isApprox(expected, 1e-9))
            << tree->frames[f].name;
      }
    }
  }
}

}  // namespace
}  // namespace springgrasp
