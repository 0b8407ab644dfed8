// The robot as a machine: it stands, every joint reaches both ends of its range, nothing collides.
#include <cmath>
#include <map>
#include <vector>

#include "control/arm_controller.h"
#include "files/model_file.h"
#include "motion/minimum_jerk.h"
#include "sim/model_index.h"
#include "sim/robot_io.h"

namespace springgrasp {
namespace {

constexpr double kDegree = M_PI / 180;
const std::vector<std::string> kVariants = {"", "_opposition"};

std::string FileOf(const std::string& variant) {
  return SPRINGGRASP_SOURCE_DIR "/models/armar3b/armar3b" + variant + ".xml";
}

// The whole robot with all motors holding: servos at their targets, arms by computed torque, hands
// at rest. Joint targets may be moved.
class Robot {
 public:
  Robot(const std::string& variant, const std::string& keyframe)
      : simulation_(LoadModelFile(FileOf(variant))) {
    mjModel& m = const_cast<mjModel&>(simulation_.model());
    mj_resetDataKeyframe(&m, &simulation_.mutable_data(), IdOf(m, mjOBJ_KEY, keyframe));
    simulation_.Forward();
    for (const char* side : {"r", "l"}) arms_.emplace_back(m, side, simulation_);
  }

  // Where a servo or an arm joint shall be, rad.
  void Target(const std::string& joint, double q) {
    for (Arm& arm : arms_) {
      for (int i = 0; i < kNumArmJoints; ++i) {
        if (joint == "arm_" + arm.side + "_" + std::string(kArmJointNames[i])) arm.target.q[i] = q;
      }
    }
    const int servo = FindId(model(), mjOBJ_ACTUATOR, joint);
    if (servo >= 0 && model().actuator_biastype[servo] == mjBIAS_AFFINE) {
      simulation_.SetControl(servo, q);
    }
  }
  void Torque(const std::string& joint, double torque) {
    simulation_.mutable_data().qfrc_applied[Dof(joint)] = torque;
  }

  void Step() {
    for (Arm& arm : arms_) {
      const RobotState state = arm.io.Read(simulation_);
      RobotCommand command;
      command.arm_torque = ControlArm({}, arm.target, state, simulation_.timestep(), arm.memory);
      for (int i = 0; i < kNumValves; ++i) command.valve_pressure[i] = 0;
      arm.io.Write(command, simulation_);
    }
    simulation_.Step();
    for (int c = 0; c < simulation_.data().ncon; ++c) {
      const mjContact& contact = simulation_.data().contact[c];
      touched_[NameOf(model(), mjOBJ_GEOM, contact.geom1) + " - " +
               NameOf(model(), mjOBJ_GEOM, contact.geom2)] = true;
    }
  }

  double Angle(const std::string& joint) const {
    return simulation_.data().qpos[model().jnt_qposadr[IdOf(model(), mjOBJ_JOINT, joint)]];
  }
  int Dof(const std::string& joint) const {
    return model().jnt_dofadr[IdOf(model(), mjOBJ_JOINT, joint)];
  }
  const mjModel& model() const { return simulation_.model(); }
  const Simulation& simulation() const { return simulation_; }
  std::map<std::string, bool>& touched() { return touched_; }

 private:
  struct Arm {
    Arm(const mjModel& model, const std::string& which, const Simulation& simulation)
        : side(which), io(model, which) {
      target.q = io.Read(simulation).arm_q;
    }
    std::string side;
    RobotIo io;
    ArmTarget target;
    ArmControlState memory;
  };
  Simulation simulation_;
  std::vector<Arm> arms_;
  std::map<std::string, bool> touched_;
};

TEST(Armar3bMotion, StandsForAMinuteWithoutDrift) {
  Robot robot("", "ready");
  std::vector<double> start(robot.simulation().data().qpos,
                            robot.simulation().data().qpos + robot.model().nq);
  double worst = 0;
  std::string which;
  while (robot.simulation().time() < 60) {
    robot.Step();
    for (int j = 0; j < robot.model().njnt; ++j) {
      const int i = robot.model().jnt_qposadr[j];
      const double drift = std::abs(robot.simulation().data().qpos[i] - start[i]);
      if (drift > worst) {
        worst = drift;
        which = NameOf(robot.model(), mjOBJ_JOINT, j);
      }
    }
  }
  EXPECT_FALSE(robot.simulation().diverged());
  EXPECT_TRUE(robot.touched().empty()) << robot.touched().begin()->first;
  EXPECT_LT(worst, 0.2 * kDegree) << which;
}

// Moves one joint there in 1.5 s and waits a second.
void MoveTo(Robot& robot, const std::string& joint, double from, double to) {
  const double start = robot.simulation().time();
  while (robot.simulation().time() < start + 2.5) {
    const double s = std::min(1.0, (robot.simulation().time() - start) / 1.5);
    robot.Target(joint, from + (to - from) * MinimumJerkPosition(s));
    robot.Step();
  }
}

// From a posture with both arms held out sideways, where nothing is in a joint's way.
TEST(Armar3bMotion, EveryJointReachesBothEndsAndComesBackWithoutContact) {
  for (const std::string& variant : kVariants) {
    Robot robot(variant, "arms_out");
    const mjModel& m = robot.model();
    while (robot.simulation().time() < 2) robot.Step();
    for (int j = 0; j < m.njnt; ++j) {
      if (!m.jnt_limited[j]) continue;
      const std::string joint = NameOf(m, mjOBJ_JOINT, j);
      const bool hand = joint.rfind("hand_", 0) == 0;
      if (!variant.empty() && joint.find("thumb") == std::string::npos) continue;
      SCOPED_TRACE(joint + variant);
      robot.touched().clear();
      const double home = robot.Angle(joint);
      for (const double end : {m.jnt_range[2 * j], m.jnt_range[2 * j + 1]}) {
        if (hand) {  // alone, which the valve of ring and pinkie cannot; then the spring opens it
          robot.Torque(joint, end > home + 0.01 ? 0.4 : -0.1);
          for (int i = 0; i < 750; ++i) robot.Step();
        } else {
          MoveTo(robot, joint, home, end);
        }
        EXPECT_NEAR(robot.Angle(joint), end, 0.5 * kDegree);
        if (hand) {
          robot.Torque(joint, 0);
          for (int i = 0; i < 1000; ++i) robot.Step();
        } else {
          MoveTo(robot, joint, end, home);
        }
        // Friction may leave a finger short of where its weak spring pulls it; the arm's
        // controller still unwinds what it integrated at the stop.
        EXPECT_NEAR(robot.Angle(joint), home, (hand ? 1.5 : 1.0) * kDegree);
      }
      EXPECT_TRUE(robot.touched().empty()) << robot.touched().begin()->first;
    }
    EXPECT_FALSE(robot.simulation().diverged());
  }
}

TEST(Armar3bMotion, OnlyPublishedPairsAreExemptFromContact) {
  const std::map<std::string, std::string> published = {
      {"armar3b", "torso_roll torso_yaw"},
      {"torso_pitch", "torso_yaw"},
      {"torso_yaw", "neck_1_pitch neck_2_roll head_tilt"},
      {"neck_base", "neck_2_roll"},
      {"neck_2_roll", "head_tilt"},
      {"arm_r_shoulder1", "arm_r_upperarm"},
      {"arm_l_shoulder1", "arm_l_upperarm"}};
  const ModelPtr m = LoadModelFile(FileOf(""));
  for (int e = 0; e < m->nexclude; ++e) {
    // The engine stores both ids plus one.
    const int first = (m->exclude_signature[e] >> 16) - 1;
    const int second = (m->exclude_signature[e] & 0xffff) - 1;
    const std::string a = NameOf(*m, mjOBJ_BODY, std::min(first, second));
    const std::string b = NameOf(*m, mjOBJ_BODY, std::max(first, second));
    ASSERT_TRUE(published.count(a)) << a << " " << b;
    EXPECT_NE(published.at(a).find(b), std::string::npos) << a << " " << b;
  }
  EXPECT_EQ(m->nexclude, 10);
}

TEST(Armar3bMotion, NoPartsTouchInTheKeyframes) {
  for (const std::string& variant : kVariants) {
    const ModelFile robot(FileOf(variant));
    for (const char* key :
         {"home", "ready", "look_at_table", "hand_open", "hand_power", "hand_pinch", "arms_out"}) {
      mj_resetDataKeyframe(robot.m(), robot.d(), robot.Id(mjOBJ_KEY, key));
      mj_forward(robot.m(), robot.d());
      EXPECT_EQ(robot.d()->ncon, 0) << key << variant;
    }
  }
}

TEST(Armar3bMotion, HandsKeepThePosturesOfTheKeyframes) {
  for (const std::string& variant : kVariants) {
    ModelFile robot(FileOf(variant));
    mjModel& m = *robot.m();
    for (double& g : m.opt.gravity) g = 0;
    for (const char* key : {"hand_open", "hand_power", "hand_pinch"}) {
      mj_resetDataKeyframe(&m, robot.d(), robot.Id(mjOBJ_KEY, key));
      const std::vector<double> start(robot.d()->qpos, robot.d()->qpos + m.nq);
      for (int i = 0; i < 500; ++i) mj_step(&m, robot.d());
      for (int j = 0; j < m.njnt; ++j) {
        const std::string joint = robot.Name(mjOBJ_JOINT, j);
        if (joint.rfind("hand_", 0) != 0) continue;
        EXPECT_NEAR(robot.Angle(joint), start[m.jnt_qposadr[j]], 0.03) << key << " " << joint;
      }
    }
  }
}

}  // namespace
}  // namespace springgrasp
