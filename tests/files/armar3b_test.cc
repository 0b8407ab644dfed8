// The robot model against the published figures.
#include <Eigen/Geometry>
#include <map>
#include <vector>

#include "base/random.h"
#include "files/model_file.h"

namespace springgrasp {
namespace {

// Joint of this model by its name in the published one.
std::string JointOf(const std::string& source) {
  static const std::map<std::string, std::string> kTrunk = {
      {"Yaw_Platform", "platform_yaw"}, {"Hip Pitch", "torso_pitch"},
      {"Hip Roll", "torso_roll"},       {"Hip Yaw", "torso_yaw"},
      {"Neck_1_Pitch", "neck_1_pitch"}, {"Neck_2_Roll", "neck_2_roll"},
      {"Neck_3_Yaw", "neck_3_yaw"},     {"Head_Tilt", "head_tilt"},
      {"Cameras", "eyes_tilt"},         {"Eye_Left", "eye_l_pan"},
      {"Eye_Right", "eye_r_pan"}};
  static const std::map<std::string, std::string> kSides = {
      {"Shoulder 1 #", "arm_#_shoulder1"}, {"Shoulder 2 #", "arm_#_shoulder2"},
      {"Upperarm #", "arm_#_upperarm"},    {"Elbow #", "arm_#_elbow"},
      {"Underarm #", "arm_#_underarm"},    {"Wrist 1 #", "arm_#_wrist1"},
      {"Wrist 2 #", "arm_#_wrist2"},       {"Hand Palm 2 #", "hand_#_palm"},
      {"Thumb # J0", "hand_#_thumb_j0"},   {"Thumb # J1", "hand_#_thumb_j1"},
      {"Index # J0", "hand_#_index_j0"},   {"Index # J1", "hand_#_index_j1"},
      {"Middle # J0", "hand_#_middle_j0"}, {"Middle # J1", "hand_#_middle_j1"},
      {"Ring # J0", "hand_#_ring_j0"},     {"Ring # J1", "hand_#_ring_j1"},
      {"Pinky # J0", "hand_#_pinkie_j0"},  {"Pinky # J1", "hand_#_pinkie_j1"}};
  if (kTrunk.count(source)) return kTrunk.at(source);
  for (const char side : {'R', 'L'}) {
    for (const auto& [name, here] : kSides) {
      std::string from = name, to = here;
      from[from.find('#')] = side;
      to[to.find('#')] = side == 'R' ? 'r' : 'l';
      if (from == source) return to;
    }
  }
  throw std::runtime_error("no joint for " + source);
}

ModelFile Armar(const std::string& variant = "") {
  return ModelFile(ModelPath("armar3b/armar3b" + variant + ".xml"));
}

// End of the distal capsule: the point that the published model calls the fingertip.
Eigen::Vector3d FingerEnd(const ModelFile& robot, const std::string& finger) {
  const std::string geom = finger + "_j1_capsule";
  const Eigen::Vector3d tip = robot.Site(finger + "_tip");
  const double radius = robot.m()->geom_size[3 * robot.Id(mjOBJ_GEOM, geom)];
  return tip + radius * (tip - robot.Geom(geom)).normalized();
}

// A point or a frame by its name in the published model.
void Find(const ModelFile& robot, const std::string& name, Eigen::Vector3d& point,
          Eigen::Matrix3d& axes) {
  static const std::map<std::string, std::string> kPoints = {
      {"TCP R", "hand_r_tcp"},           {"TCP L", "hand_l_tcp"},
      {"Hand R Base", "hand_r"},         {"Hand L Base", "hand_l"},
      {"Eye_Left", "eye_l_pan"},         {"Eye_Right", "eye_r_pan"},
      {"EyeLeftCamera", "eye_l_wide"},   {"EyeRightCamera", "eye_r_wide"},
      {"Thumb R tip", "hand_r_thumb"},   {"Index R tip", "hand_r_index"},
      {"Middle R tip", "hand_r_middle"}, {"Ring R tip", "hand_r_ring"},
      {"Pinky R tip", "hand_r_pinkie"},  {"Thumb L tip", "hand_l_thumb"},
      {"Index L tip", "hand_l_index"},   {"Middle L tip", "hand_l_middle"},
      {"Ring L tip", "hand_l_ring"},     {"Pinky L tip", "hand_l_pinkie"}};
  const std::string here = kPoints.at(name);
  if (name.find("tip") != std::string::npos) {
    point = FingerEnd(robot, here);
  } else if (name.find("TCP") != std::string::npos) {
    point = robot.Site(here);
    axes = robot.SiteAxes(here);
  } else if (name.find("Camera") != std::string::npos) {
    const int camera = robot.Id(mjOBJ_CAMERA, here);
    point = Eigen::Map<const Eigen::Vector3d>(robot.d()->cam_xpos + 3 * camera);
    axes = robot.CameraAxes(here);
  } else {
    point = robot.Body(here);
  }
}

TEST(Armar3b, ForwardKinematicsMeetsEveryPublishedPosition) {
  const YAML::Node checks =
      YAML::LoadFile(std::string(SPRINGGRASP_TESTDATA_DIR) + "/armar3_checks.yaml");
  int compared = 0;
  for (const char* variant : {"", "_opposition"}) {
    for (const auto& check : checks) {
      SCOPED_TRACE(check["config"].as<std::string>() + variant);
      ModelFile robot = Armar(variant);
      for (const auto& entry : check["q"]) {
        robot.Angle(JointOf(entry.first.as<std::string>())) = entry.second.as<double>();
      }
      mj_kinematics(robot.m(), robot.d());
      mj_camlight(robot.m(), robot.d());
      for (const auto& entry : check["expect"]) {
        const std::string name = entry.first.as<std::string>();
        Eigen::Vector3d point;
        Eigen::Matrix3d axes;
        Find(robot, name, point, axes);
        ++compared;
        EXPECT_LT((point - ToVector(entry.second["pos"])).norm(), 1e-5) << name;
        if (entry.second["quat"]) {
          const auto q = entry.second["quat"].as<std::vector<double>>();
          const Eigen::Quaterniond expected(q[0], q[1], q[2], q[3]);
          EXPECT_LT(expected.angularDistance(Eigen::Quaterniond(axes)), 1e-5) << name;
        }
        if (entry.second["view"]) {  // MuJoCo cameras look along their -z, y up
          EXPECT_LT((-axes.col(2) - ToVector(entry.second["view"])).norm(), 1e-5) << name;
          EXPECT_LT((axes.col(1) - ToVector(entry.second["up"])).norm(), 1e-5) << name;
        }
      }
    }
  }
  EXPECT_EQ(compared, 2 * 5 * 18);
}

TEST(Armar3b, PlatformSlidesToTheRightAndForwardAndTurnsLast) {
  ModelFile robot = Armar();
  const Eigen::Vector3d before = robot.Body("hand_r");
  robot.Angle("platform_x") = 0.3;
  robot.Angle("platform_y") = -0.2;
  robot.Angle("platform_yaw") = M_PI / 2;
  mj_kinematics(robot.m(), robot.d());
  const Eigen::Vector3d expected(0.3 - before.y(), -0.2 + before.x(), before.z());
  EXPECT_LT((robot.Body("hand_r") - expected).norm(), 1e-9);
}

TEST(Armar3b, FortyThreeActuatorsDriveFortyNineJointsAndFourCamerasLook) {
  const ModelFile robot = Armar();
  EXPECT_EQ(robot.m()->nu, 43);
  EXPECT_EQ(robot.m()->njnt, 49);
  EXPECT_EQ(robot.m()->nv, 49);
  EXPECT_EQ(robot.m()->ncam, 4);
  EXPECT_EQ(Armar("_opposition").m()->nu, 43);
  EXPECT_EQ(Armar("_opposition").m()->njnt, 51);
  std::map<int, int> driven;
  for (int i = 0; i < robot.m()->nu; ++i) {
    const int id = robot.m()->actuator_trnid[2 * i];
    if (robot.m()->actuator_trntype[i] == mjTRN_JOINT) {
      ++driven[id];
    } else {
      for (int w = 0; w < robot.m()->tendon_num[id]; ++w) {
        ++driven[robot.m()->wrap_objid[robot.m()->tendon_adr[id] + w]];
      }
    }
  }
  for (int j = 0; j < robot.m()->njnt; ++j) EXPECT_EQ(driven[j], 1) << robot.Name(mjOBJ_JOINT, j);
}

TEST(Armar3b, FovealCamerasLookAlongTheWideOnesJustAboveThem) {
  const ModelFile robot = Armar();
  for (const std::string eye : {"eye_l", "eye_r"}) {
    const int wide = robot.Id(mjOBJ_CAMERA, eye + "_wide");
    const int foveal = robot.Id(mjOBJ_CAMERA, eye + "_foveal");
    const auto at = [&](int camera) {
      return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(robot.d()->cam_xpos + 3 * camera));
    };
    EXPECT_TRUE(robot.CameraAxes(eye + "_wide").isApprox(robot.CameraAxes(eye + "_foveal"), 1e-9));
    EXPECT_LT((at(foveal) - at(wide) - Eigen::Vector3d(0, 0, 0.012)).norm(), 1e-9);
    EXPECT_NEAR(robot.m()->cam_fovy[wide], 47.88, 1e-9);
    EXPECT_NEAR(robot.m()->cam_fovy[foveal], 16.84, 1e-9);
  }
}

TEST(Armar3b, MassesAreThoseOfThePublishedModelAndTheRecommendedHand) {
  for (const char* variant : {"", "_opposition"}) {
    const ModelFile robot = Armar(variant);
    auto below = [&](const std::string& body) {
      return robot.m()->body_subtreemass[robot.Id(mjOBJ_BODY, body)];
    };
    for (const std::string side : {"r", "l"}) {
      EXPECT_NEAR(below("hand_" + side), 0.45, 1e-9);
      EXPECT_NEAR(below("arm_" + side + "_shoulder1") - below("hand_" + side), 12.4294, 1e-4);
    }
    EXPECT_NEAR(below("neck_base"), 18.79877, 1e-5);
    EXPECT_NEAR(below("torso_pitch") - below("neck_base") - 2 * below("arm_r_shoulder1"), 35.415,
                1e-3);
    // Of the published 192.273 kg, with 0.45 instead of 6.6 kg for each hand.
    EXPECT_NEAR(below("armar3b"), 192.273 - 2 * (6.6 - 0.45), 1e-3);
  }
}

TEST(Armar3b, ArmMotorsHaveTwiceTheGravityTorqueInAnyPosture) {
  ModelFile robot = Armar();
  auto random = MakeStream(1, 0, "postures");
  for (int sample = 0; sample < 2000; ++sample) {
    for (int j = 0; j < robot.m()->njnt; ++j) {
      if (robot.Name(mjOBJ_JOINT, j).rfind("arm_", 0) != 0) continue;
      robot.d()->qpos[robot.m()->jnt_qposadr[j]] =
          Uniform(random, robot.m()->jnt_range[2 * j], robot.m()->jnt_range[2 * j + 1]);
    }
    mj_fwdPosition(robot.m(), robot.d());
    mj_rne(robot.m(), robot.d(), 0, robot.d()->qfrc_bias);
    for (int i = 0; i < robot.m()->nu; ++i) {
      const std::string name = robot.Name(mjOBJ_ACTUATOR, i);
      if (name.rfind("arm_", 0) != 0) continue;
      const int dof = robot.m()->jnt_dofadr[robot.Id(mjOBJ_JOINT, name)];
      ASSERT_GT(robot.m()->actuator_forcerange[2 * i + 1],
                2.0 * std::abs(robot.d()->qfrc_bias[dof]))
          << name;
    }
  }
}

}  // namespace
}  // namespace springgrasp
