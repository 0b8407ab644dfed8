// The robot model against the published figures and the rules of the hand.
#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "base/random.h"
#include "files/model_file.h"

namespace springgrasp {
namespace {

const std::vector<std::string> kFingers = {"thumb", "index", "middle", "ring", "pinkie"};

// Joints of the published model by the names used here; left arm and platform are not in this
// model.
const std::map<std::string, std::string> kJoints = {{"Hip Pitch", "torso_pitch"},
                                                    {"Hip Roll", "torso_roll"},
                                                    {"Hip Yaw", "torso_yaw"},
                                                    {"Neck_1_Pitch", "neck_1_pitch"},
                                                    {"Neck_2_Roll", "neck_2_roll"},
                                                    {"Neck_3_Yaw", "neck_3_yaw"},
                                                    {"Head_Tilt", "head_tilt"},
                                                    {"Cameras", "eyes_tilt"},
                                                    {"Eye_Left", "eye_l_pan"},
                                                    {"Eye_Right", "eye_r_pan"},
                                                    {"Shoulder 1 R", "arm_r_shoulder1"},
                                                    {"Shoulder 2 R", "arm_r_shoulder2"},
                                                    {"Upperarm R", "arm_r_upperarm"},
                                                    {"Elbow R", "arm_r_elbow"},
                                                    {"Underarm R", "arm_r_underarm"},
                                                    {"Wrist 1 R", "arm_r_wrist1"},
                                                    {"Wrist 2 R", "arm_r_wrist2"},
                                                    {"Hand Palm 2 R", "hand_r_palm"},
                                                    {"Thumb R J0", "hand_r_thumb_j0"},
                                                    {"Thumb R J1", "hand_r_thumb_j1"},
                                                    {"Index R J0", "hand_r_index_j0"},
                                                    {"Index R J1", "hand_r_index_j1"},
                                                    {"Middle R J0", "hand_r_middle_j0"},
                                                    {"Middle R J1", "hand_r_middle_j1"},
                                                    {"Ring R J0", "hand_r_ring_j0"},
                                                    {"Ring R J1", "hand_r_ring_j1"},
                                                    {"Pinky R J0", "hand_r_pinkie_j0"},
                                                    {"Pinky R J1", "hand_r_pinkie_j1"}};

const std::map<std::string, std::vector<std::string>> kValveJoints = {
    {"hand_r_palm", {"hand_r_palm"}},
    {"hand_r_thumb_proximal", {"hand_r_thumb_j0"}},
    {"hand_r_thumb_distal", {"hand_r_thumb_j1"}},
    {"hand_r_index_proximal", {"hand_r_index_j0"}},
    {"hand_r_index_distal", {"hand_r_index_j1"}},
    {"hand_r_middle_proximal", {"hand_r_middle_j0"}},
    {"hand_r_middle_distal", {"hand_r_middle_j1"}},
    {"hand_r_ring_pinkie",
     {"hand_r_ring_j0", "hand_r_ring_j1", "hand_r_pinkie_j0", "hand_r_pinkie_j1"}}};

ModelFile Armar() { return ModelFile(ModelPath("armar3b/armar3b.xml")); }

std::string TipSite(const std::string& finger) { return "hand_r_" + finger + "_tip"; }

// End of the distal capsule: the point that the published model calls the fingertip.
Eigen::Vector3d FingerEnd(const ModelFile& robot, const std::string& finger) {
  const std::string geom = "hand_r_" + finger + "_j1_capsule";
  const Eigen::Vector3d tip = robot.Site(TipSite(finger));
  const double radius = robot.m()->geom_size[3 * robot.Id(mjOBJ_GEOM, geom)];
  return tip + radius * (tip - robot.Geom(geom)).normalized();
}

// A point or a frame by its name in the published model; false if it is not in this model.
bool Find(const ModelFile& robot, const std::string& name, Eigen::Vector3d& point,
          Eigen::Matrix3d& axes) {
  static const std::map<std::string, std::string> kCameras = {{"EyeLeftCamera", "eye_l_wide"},
                                                              {"EyeRightCamera", "eye_r_wide"}};
  static const std::map<std::string, std::string> kTips = {{"Thumb R tip", "thumb"},
                                                           {"Index R tip", "index"},
                                                           {"Middle R tip", "middle"},
                                                           {"Ring R tip", "ring"},
                                                           {"Pinky R tip", "pinkie"}};
  if (name == "TCP R") {
    point = robot.Site("hand_r_tcp");
    axes = robot.SiteAxes("hand_r_tcp");
  } else if (name == "Hand R Base") {
    point = robot.Body("hand_r");
  } else if (kCameras.count(name)) {
    const int camera = robot.Id(mjOBJ_CAMERA, kCameras.at(name));
    point = Eigen::Map<const Eigen::Vector3d>(robot.d()->cam_xpos + 3 * camera);
    axes = robot.CameraAxes(kCameras.at(name));
  } else if (kTips.count(name)) {
    point = FingerEnd(robot, kTips.at(name));
  } else if (kJoints.count(name)) {
    point = robot.Body(kJoints.at(name));
  } else {
    return false;
  }
  return true;
}

TEST(Armar3b, ForwardKinematicsMeetsThePublishedPositions) {
  const YAML::Node checks =
      YAML::LoadFile(std::string(SPRINGGRASP_TESTDATA_DIR) + "/armar3_checks.yaml");
  int compared = 0;
  for (const auto& check : checks) {
    SCOPED_TRACE(check["config"].as<std::string>());
    ModelFile robot = Armar();
    Eigen::Matrix3d yaw = Eigen::Matrix3d::Identity();  // of the platform, which stands fixed here
    for (const auto& entry : check["q"]) {
      const auto joint = kJoints.find(entry.first.as<std::string>());
      if (joint != kJoints.end()) robot.Angle(joint->second) = entry.second.as<double>();
      if (entry.first.as<std::string>() == "Yaw_Platform") {
        yaw = Eigen::AngleAxisd(entry.second.as<double>(), Eigen::Vector3d::UnitZ());
      }
    }
    mj_kinematics(robot.m(), robot.d());
    mj_camlight(robot.m(), robot.d());
    for (const auto& entry : check["expect"]) {
      const std::string name = entry.first.as<std::string>();
      Eigen::Vector3d point;
      Eigen::Matrix3d axes;
      if (!Find(robot, name, point, axes)) continue;
      ++compared;
      EXPECT_LT((yaw * point - ToVector(entry.second["pos"])).norm(), 1e-5) << name;
      if (entry.second["quat"]) {
        const auto q = entry.second["quat"].as<std::vector<double>>();
        const Eigen::Quaterniond expected(q[0], q[1], q[2], q[3]);
        EXPECT_LT(expected.angularDistance(Eigen::Quaterniond(yaw * axes)), 1e-5) << name;
      }
      if (entry.second["view"]) {  // MuJoCo cameras look along their -z, y up
        EXPECT_LT((-yaw * axes.col(2) - ToVector(entry.second["view"])).norm(), 1e-5) << name;
        EXPECT_LT((yaw * axes.col(1) - ToVector(entry.second["up"])).norm(), 1e-5) << name;
      }
    }
  }
  EXPECT_EQ(compared, 5 * 11);
}

TEST(Armar3b, MassesAreThoseOfThePublishedModelAndTheRecommendedHand) {
  const ModelFile robot = Armar();
  auto below = [&](const std::string& body) {
    return robot.m()->body_subtreemass[robot.Id(mjOBJ_BODY, body)];
  };
  EXPECT_NEAR(below("hand_r"), 0.45, 1e-9);
  EXPECT_NEAR(below("arm_r_shoulder1") - below("hand_r"), 12.4294, 1e-4);
  EXPECT_NEAR(below("neck_base"), 18.79877, 1e-5);
  EXPECT_NEAR(below("torso_pitch") - below("neck_base") - below("arm_r_shoulder1"), 35.415, 1e-6);
}

TEST(Armar3b, HandFrameLooksToTheMiddleKnuckleWithItsBackUp) {
  const ModelFile robot = Armar();
  const Eigen::Matrix3d H = robot.SiteAxes("hand_r_H");
  const Eigen::Vector3d origin = robot.Site("hand_r_H");
  const Eigen::Vector3d knuckle = robot.Body("hand_r_middle_j0") - origin;
  EXPECT_LT((origin - robot.Body("hand_r")).norm(), 1e-9);
  EXPECT_LT((H.col(0) - knuckle.normalized()).norm(), 1e-6);
  EXPECT_GT(H.col(2).dot(robot.BodyAxes("hand_r").col(0)), 0.99);
  EXPECT_GT(H.col(1).dot(robot.Body("hand_r_index_j0") - robot.Body("hand_r_pinkie_j0")), 0.07);
  EXPECT_LT(H.col(2).dot(robot.Site("hand_r_thumb_tip") - origin), 0.0);
}

TEST(Armar3b, TipSitesAreTheCentresOfTheDistalCapsulesEndSpheres) {
  const ModelFile robot = Armar();
  for (const std::string& finger : kFingers) {
    const std::string geom = "hand_r_" + finger + "_j1_capsule";
    const double* size = robot.m()->geom_size + 3 * robot.Id(mjOBJ_GEOM, geom);
    const Eigen::Vector3d axis = robot.GeomAxes(geom).col(2);
    const Eigen::Vector3d offset = robot.Site(TipSite(finger)) - robot.Geom(geom);
    EXPECT_NEAR(size[0], 0.0093, 1e-9);
    EXPECT_NEAR(std::abs(offset.dot(axis)), size[1], 1e-8) << finger;
    EXPECT_NEAR(offset.norm(), size[1], 1e-8) << finger;
    EXPECT_GT(offset.dot(robot.Site(TipSite(finger)) - robot.Body("hand_r_" + finger + "_j1")), 0);
  }
}

TEST(Armar3b, EightValvesDriveElevenHandJoints) {
  const ModelFile robot = Armar();
  int valves = 0;
  for (int i = 0; i < robot.m()->nu; ++i) {
    if (robot.Name(mjOBJ_ACTUATOR, i).rfind("hand_", 0) == 0) ++valves;
  }
  EXPECT_EQ(valves, 8);
  for (const auto& [valve, joints] : kValveJoints) {
    const int i = robot.Id(mjOBJ_ACTUATOR, valve);
    EXPECT_EQ(robot.m()->actuator_ctrlrange[2 * i], 0.0);
    EXPECT_EQ(robot.m()->actuator_ctrlrange[2 * i + 1], 5.0);
    EXPECT_EQ(robot.m()->actuator_dynprm[mjNDYN * i], 0.1);
    for (const std::string& joint : joints) EXPECT_GT(robot.UpperLimit(joint), 0.5);
  }
}

// The robot without gravity, everything but the hand held still by damping.
ModelFile FloatingHand() {
  ModelFile robot = Armar();
  for (double& g : robot.m()->opt.gravity) g = 0.0;
  for (int i = 0; i < robot.m()->nv; ++i) {
    const std::string joint = robot.Name(mjOBJ_JOINT, robot.m()->dof_jntid[i]);
    if (joint.rfind("hand_", 0) != 0) robot.m()->dof_damping[i] = 1e4;
  }
  return robot;
}

TEST(Armar3b, EachValveAtFullPressureClosesItsJointsTowardsThePalmAndTheSpringsOpenThem) {
  for (const auto& [valve, joints] : kValveJoints) {
    SCOPED_TRACE(valve);
    ModelFile robot = FloatingHand();
    const bool is_thumb = valve.find("thumb") != std::string::npos;
    const std::string finger = is_thumb                                   ? "thumb"
                               : valve.find("index") != std::string::npos ? "index"
                               : valve.find("ring") != std::string::npos  ? "ring"
                                                                          : "middle";
    auto tip_in_H = [&] {
      return Eigen::Vector3d(robot.SiteAxes("hand_r_H").transpose() *
                             (robot.Site(TipSite(finger)) - robot.Site("hand_r_H")));
    };
    const Eigen::Vector3d open = tip_in_H();
    robot.d()->ctrl[robot.Id(mjOBJ_ACTUATOR, valve)] = 5.0;
    while (robot.d()->time < 1.0) mj_step(robot.m(), robot.d());
    for (const std::string& joint :
         joints) {  // ring and pinkie end at the palm, before their stops
      EXPECT_GT(robot.Angle(joint), 0.85 * robot.UpperLimit(joint)) << joint;
    }
    const Eigen::Vector3d moved = tip_in_H() - open;
    // Fingers flex to the palm's side (-z); the thumb, which stands out of the palm, along it.
    EXPECT_GT(is_thumb ? moved.x() : -moved.z(), 0.03);

    robot.d()->ctrl[robot.Id(mjOBJ_ACTUATOR, valve)] = 0.0;
    while (robot.d()->time < 3.0) mj_step(robot.m(), robot.d());
    for (const std::string& joint : joints) EXPECT_LT(robot.Angle(joint), 0.02) << joint;
    EXPECT_EQ(robot.NumWarnings(), 0);
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

TEST(Armar3b, NoPartsTouchInTheNamedPostures) {
  ModelFile robot = Armar();
  ASSERT_GE(robot.m()->nkey, 2);
  for (int key = 0; key < robot.m()->nkey; ++key) {
    mj_resetDataKeyframe(robot.m(), robot.d(), key);
    mj_forward(robot.m(), robot.d());
    EXPECT_EQ(robot.d()->ncon, 0) << robot.Name(mjOBJ_KEY, key);
  }
}

// True if one body stands at most two bodies below the other.
bool AreNeighbours(const mjModel& model, int a, int b) {
  if (a < b) std::swap(a, b);  // children stand behind their parents
  const int parent = model.body_parentid[a];
  return parent == b || model.body_parentid[parent] == b;
}

// Near its ends a joint may run into a neighbour: these are stops (bent elbow, bent wrist).
TEST(Armar3b, NeighboursDoNotTouchInTheInnerFourFifthsOfAJointsRange) {
  ModelFile robot = Armar();
  for (int j = 0; j < robot.m()->njnt; ++j) {
    const std::string joint = robot.Name(mjOBJ_JOINT, j);
    mj_resetData(robot.m(), robot.d());
    for (int step = 0; step <= 20; ++step) {
      const double* range = robot.m()->jnt_range + 2 * j;
      robot.Angle(joint) = range[0] + (0.1 + 0.04 * step) * (range[1] - range[0]);
      mj_fwdPosition(robot.m(), robot.d());
      for (int c = 0; c < robot.d()->ncon; ++c) {
        const mjContact& contact = robot.d()->contact[c];
        const int* body = robot.m()->geom_bodyid;
        if (!AreNeighbours(*robot.m(), body[contact.geom1], body[contact.geom2])) continue;
        ADD_FAILURE() << joint << " at " << robot.Angle(joint) << ": "
                      << robot.Name(mjOBJ_GEOM, contact.geom1) << " meets "
                      << robot.Name(mjOBJ_GEOM, contact.geom2);
      }
    }
  }
}

}  // namespace
}  // namespace springgrasp
