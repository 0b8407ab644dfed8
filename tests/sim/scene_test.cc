#include "sim/scene.h"

#include <gmock/gmock.h>

#include <cmath>

#include "base/error.h"
#include "sim/model_index.h"
#include "sim/ring.h"
#include "sim/sim_fixture.h"

namespace springgrasp {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string MessageOf(const std::string& yaml) {
  try {
    ParseScene(yaml, "scene.yaml");
  } catch (const Error& e) {
    return e.what();
  }
  return "(no error)";
}

TEST(SceneTest, EveryKeyIsRead) {
  const Scene s = ReadScene(TestFile("sim_scene.yaml"));
  ASSERT_EQ(s.objects.size(), 3u);
  EXPECT_EQ(s.objects[0].name, "ball");
  EXPECT_EQ(s.objects[0].friction, 0.8);
  EXPECT_TRUE(s.objects[0].on_ring);
  EXPECT_EQ(s.objects[0].pose_noise.y, 0.02);
  EXPECT_EQ(s.objects[0].believed.mass, -0.2);
  EXPECT_EQ(s.objects[2].shape->kind, Shape::Kind::kBox);
  EXPECT_EQ(s.start.at("torso_yaw"), 0.2);
  EXPECT_EQ(s.demonstrator.type, "power");
  EXPECT_FALSE(s.demonstrator.object_visible);
  EXPECT_EQ(s.demonstrator.object->size.x(), 0.06);
  EXPECT_EQ(s.demonstrator.hand_length, 0.18);
  EXPECT_EQ(s.demonstrator.cap_diameter, 0.022);
  EXPECT_EQ(s.demonstrator.cap_colour, Eigen::Vector3d(0.1, 0.2, 0.9));
  EXPECT_EQ(s.demonstrator.skin_colour, Eigen::Vector3d(0.5, 0.35, 0.3));
  EXPECT_EQ(s.physics.noslip_iterations, 3);
  EXPECT_EQ(s.max_finger_force, 6);
  EXPECT_EQ(s.lights.size(), 1u);
}

TEST(SceneTest, DefaultsGiveLightsAndTwoCameras) {
  const Scene s = ParseScene("objects: [{shape: 'sphere:0.04', pose: [0.3, 0.6]}]", "s.yaml");
  ASSERT_EQ(s.cameras.size(), 2u);
  EXPECT_EQ(s.cameras[0].name, "front");
  EXPECT_EQ(s.cameras[1].name, "close");
  EXPECT_FALSE(s.lights.empty());
}

TEST(SceneTest, ErrorsNameFileLineAndWhatIsValid) {
  EXPECT_THAT(MessageOf("torso: fixed\ntabel: {height: 1}\n"),
              AllOf(HasSubstr("scene.yaml:2"), HasSubstr("tabel"), HasSubstr("table")));
  EXPECT_THAT(MessageOf("objects:\n  - shape: sphere:0.04\n    mass: -0.1\n    pose: [0, 0.5]\n"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("mass"), HasSubstr("-0.1")));
  EXPECT_THAT(MessageOf("objects:\n  - shape: sphere:0.04\n    pose: [0]\n"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("pose has 1 numbers")));
  EXPECT_THAT(MessageOf("objects:\n  - shape: ball:0.04\n    pose: [0, 0.5]\n"),
              AllOf(HasSubstr("scene.yaml:2"), HasSubstr("sphere:D")));
  EXPECT_THAT(MessageOf("objects:\n  - pose: [0, 0.5]\n"), HasSubstr("either a shape or a model"));
  EXPECT_THAT(MessageOf("hand: opposed\n"),
              AllOf(HasSubstr("scene.yaml:1"), HasSubstr("documented")));
  EXPECT_THAT(MessageOf("active: [right_leg]\n"),
              AllOf(HasSubstr("scene.yaml:1"), HasSubstr("right_arm")));
  EXPECT_THAT(MessageOf("demonstrator: {kind: recorded, file: nowhere.csv}\n"),
              AllOf(HasSubstr("scene.yaml:1"), HasSubstr("nowhere.csv")));
  EXPECT_THAT(MessageOf("objects:\n  - {name: a, shape: sphere:0.04, pose: [0, 0.5]}\n"
                        "  - {name: a, shape: sphere:0.04, pose: [0, 0.6]}\n"),
              HasSubstr("a second object is named 'a'"));
}

TEST(SceneTest, LookOfTheDemonstratorIsThatOfTheModelUnlessGiven) {
  const Scene s = ParseScene("demonstrator: {hand_length: 0.2}\n", "s.yaml");
  EXPECT_FALSE(s.demonstrator.cap_diameter);
  EXPECT_FALSE(s.demonstrator.cap_colour);
  EXPECT_FALSE(s.demonstrator.skin_colour);
}

TEST(SceneTest, CapsAndSkinOutOfRangeAreErrorsWithFileAndLine) {
  const auto demonstrator = [](const std::string& key) {
    return MessageOf("demonstrator:\n  type: pinch\n  " + key + "\n");
  };
  EXPECT_THAT(demonstrator("cap_diameter: 0.2"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("cap_diameter"), HasSubstr("0.03")));
  EXPECT_THAT(demonstrator("cap_diameter: green"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("cap_diameter")));
  EXPECT_THAT(demonstrator("cap_colour: [0, 255, 0]"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("cap_colour"), HasSubstr("255")));
  EXPECT_THAT(demonstrator("cap_colour: [0.5, 0.5, 0.5]"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("a bright colour with a hue")));
  EXPECT_THAT(demonstrator("cap_colour: [0, 0.1, 0]"), HasSubstr("a bright colour with a hue"));
  EXPECT_THAT(demonstrator("skin_colour: [0.5, 0.4]"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("skin_colour")));
  EXPECT_THAT(demonstrator("hand_length: 0.5"),
              AllOf(HasSubstr("scene.yaml:3"), HasSubstr("hand_length"), HasSubstr("0.3")));
}

TEST(SceneTest, RestingObjectsStandOnTheTable) {
  const Scene s = ReadScene(TestFile("sim_scene.yaml"));
  EXPECT_DOUBLE_EQ(ObjectStartPose(s, ObjectIndex(s, "can")).translation().z(), 0.9 + 0.08);
  EXPECT_DOUBLE_EQ(ObjectStartPose(s, ObjectIndex(s, "block")).translation().z(), 0.9 + 0.03);
  // The ball touches the ring's capsules and not the table.
  const Ring ring = RingForSphere(0.04);
  const double z = ObjectStartPose(s, 0).translation().z() - 0.9;
  EXPECT_GT(z, 0.02);
  EXPECT_LT(z, 0.03);
  const double a = ring.radius * std::cos(M_PI / ring.segments);
  EXPECT_NEAR(std::hypot(a, z - ring.tube), 0.02 + ring.tube, 1e-12);
  EXPECT_THROW(ObjectIndex(s, "cup"), Error);
}

// A scene beside the test's files, with one object.
Scene SceneOf(const std::string& object) {
  return ParseScene("objects: [{name: thing, " + object + "}]", TestFile("thing.yaml"));
}

TEST(SceneTest, FileObjectsHaveTheMassAndFrictionOfTheirFile) {
  const SceneObject o = SceneOf("model: sim_tool.xml, pose: [0.3, 0.6]").objects[0];
  EXPECT_NEAR(o.mass, 0.08, 1e-12);
  EXPECT_EQ(o.friction, 0.4);  // the least of its parts
  EXPECT_TRUE(o.friction_of_file);
  const BelievedObject told =
      BelieveObject(SceneOf("model: sim_tool.xml, pose: [0.3, 0.6], believed: {mass: 0.5}"), 0);
  EXPECT_NEAR(told.mass, 0.12, 1e-12);
  EXPECT_EQ(told.friction, 0.4);
}

TEST(SceneTest, TheScenesMassAndFrictionOverruleTheFile) {
  const Scene s = SceneOf("model: sim_tool.xml, pose: [0.3, 0.6], mass: 0.3, friction: 0.55");
  EXPECT_FALSE(s.objects[0].friction_of_file);
  EXPECT_EQ(BelieveObject(s, 0).mass, 0.3);
  EXPECT_EQ(BelieveObject(s, 0).friction, 0.55);
}

TEST(SceneTest, AShapeBesideAFileIsWhatTheRobotTakesItFor) {
  const Scene s = SceneOf("model: sim_tool.xml, shape: 'box:0.06x0.02x0.03', pose: [0.3, 0.6]");
  EXPECT_EQ(BelieveObject(s, 0).shape->size.z(), 0.03);
  EXPECT_NEAR(ObjectStartPose(s, 0).translation().z() - s.table.height, 0.01, 1e-9);  // the file's
  BuildOptions options;
  options.with_robot = false;
  EXPECT_GE(FindId(*BuildModel(s, options), mjOBJ_GEOM, "thing_rod"), 0);
}

TEST(SceneTest, MeshesHaveTheDefaultMassAndFriction) {
  const SceneObject o = SceneOf("model: sim_wedge.obj, pose: [0.3, 0.6]").objects[0];
  EXPECT_EQ(o.mass, SceneObject().mass);
  EXPECT_EQ(o.friction, SceneObject().friction);
}

TEST(SceneTest, RestingFileObjectsTouchTheTableWithTheirLowestPoint) {
  const auto height = [](const std::string& object) {
    const Scene s = SceneOf(object);
    return ObjectStartPose(s, 0).translation().z() - s.table.height;
  };
  EXPECT_NEAR(height("model: sim_cup.xml, pose: [0.3, 0.6]"), 0, 1e-9);
  EXPECT_NEAR(height("model: sim_tool.xml, pose: [0.3, 0.6], yaw: 0.7"), 0.01, 1e-9);
  // The wider sphere of the egg sits on the ring; its centre is 5 mm below the egg's origin.
  const Ring ring = RingForSphere(0.04);
  EXPECT_NEAR(height("model: sim_egg.xml, pose: [0.3, 0.6], on_ring: true"),
              SphereHeightOnRing(ring, 0.02) + 0.005, 1e-9);
}

TEST(SceneTest, UnfitObjectFilesAreErrorsThatNameSceneAndFile) {
  const auto message = [](const std::string& object) -> std::string {
    try {
      SceneOf(object);
    } catch (const Error& e) {
      return e.what();
    }
    return "(no error)";
  };
  EXPECT_THAT(message("model: sim_cup.xml, pose: [0, 0.6], on_ring: true"),
              AllOf(HasSubstr("thing.yaml:1"), HasSubstr("spheres on the z axis")));
  EXPECT_THAT(message("model: nothing.xml, pose: [0, 0.6]"),
              AllOf(HasSubstr("thing.yaml:1"), HasSubstr("nothing.xml")));
  const std::string world = "<mujoco><compiler angle='radian'/><worldbody>{}</worldbody></mujoco>";
  const std::string ball = "<body><geom size='0.02'/></body>";
  const std::string glass = "<body><geom size='0.02' contype='0' conaffinity='0'/></body>";
  const std::string path = ::testing::TempDir() + "scene_test_object.xml";
  const std::string use = "model: '" + path + "', pose: [0, 0.6]";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {ball + ball, "exactly one body"}, {"", "exactly one body"}, {glass, "can be touched"}};
  for (const auto& [bodies, reason] : cases) {
    WriteFileAtomically(path, fmt::format(fmt::runtime(world), bodies));
    EXPECT_THAT(message(use), AllOf(HasSubstr("thing.yaml:1"), HasSubstr(path), HasSubstr(reason)));
  }
}

TEST(SceneTest, DrawsStayWithinTheNoiseAndRepeat) {
  const Scene s = ReadScene(TestFile("sim_scene.yaml"));
  const Eigen::Vector3d before = s.objects[0].X_WO.translation();
  double largest_y = 0;
  for (std::uint64_t k = 0; k < 200; ++k) {
    Scene drawn = s, again = s;
    RandomEngine e1 = MakeStream(7, k, "pose"), e2 = MakeStream(7, k, "pose");
    DrawObjectPoses(drawn, e1);
    DrawObjectPoses(again, e2);
    const Eigen::Vector3d d = drawn.objects[0].X_WO.translation() - before;
    EXPECT_LE(std::abs(d.x()), 0.01);
    EXPECT_LE(std::abs(d.y()), 0.02);
    EXPECT_EQ(d.z(), 0);
    EXPECT_LE(std::abs(drawn.objects[0].yaw - s.objects[0].yaw), 0.3);
    EXPECT_EQ(drawn.objects[0].X_WO.matrix(), again.objects[0].X_WO.matrix());
    EXPECT_EQ(drawn.objects[1].X_WO.matrix(), s.objects[1].X_WO.matrix());
    largest_y = std::max(largest_y, std::abs(d.y()));
  }
  EXPECT_GT(largest_y, 0.018);
}

TEST(SceneTest, BeliefIsTruthPlusError) {
  const Scene s = ReadScene(TestFile("sim_scene.yaml"));
  const BelievedObject b = BelieveObject(s, 0);
  const Pose truth = ObjectStartPose(s, 0);
  EXPECT_TRUE((b.X_WO.translation() - truth.translation())
                  .isApprox(Eigen::Vector3d(0.01, 0, -0.002), 1e-9));
  EXPECT_NEAR(
      RotationDistance(Eigen::Quaterniond(b.X_WO.linear()), Eigen::Quaterniond(truth.linear())),
      0.1, 1e-9);
  EXPECT_NEAR(b.shape->size.x(), 0.044, 1e-12);
  EXPECT_NEAR(b.mass, 0.08, 1e-12);
  EXPECT_NEAR(b.friction, 1.2, 1e-12);
}

TEST(SceneEyesTest, AreIdealUnlessTheSceneSaysOtherwise) {
  const SceneEyes e = ParseScene("torso: fixed\n", "s.yaml").eyes;
  EXPECT_EQ(e.width, 640);
  EXPECT_EQ(e.height, 480);
  EXPECT_EQ(e.noise, 0);
  EXPECT_EQ(e.exposure, 0);
  for (const double k : e.distortion) EXPECT_EQ(k, 0);
  EXPECT_EQ(e.brightness_drift + e.white_balance_drift + e.frame_drops + e.time_offset, 0);
  EXPECT_EQ(e.calibration_error.rotation + e.calibration_error.focal, 0);
  EXPECT_EQ(e.tracker, "outline");
}

TEST(SceneEyesTest, EveryKeyIsRead) {
  const SceneEyes e = ParseScene(
                          "eyes:\n"
                          "  width: 1280\n  height: 720\n  noise: 6\n"
                          "  distortion: [-0.25, 0.08, 0.001, 0.002, 0.01]\n"
                          "  exposure: 0.01\n  subframes: 5\n"
                          "  brightness_drift: 0.4\n  white_balance_drift: 0.1\n"
                          "  frame_drops: 0.05\n  time_offset: 0.004\n"
                          "  calibration_error: {rotation: 0.002, focal: -0.01}\n"
                          "  tracker: paper\n",
                          "s.yaml")
                          .eyes;
  EXPECT_EQ(e.width, 1280);
  EXPECT_EQ(e.height, 720);
  EXPECT_EQ(e.noise, 6);
  EXPECT_EQ(e.distortion, (std::array<double, 5>{-0.25, 0.08, 0.001, 0.002, 0.01}));
  EXPECT_EQ(e.exposure, 0.01);
  EXPECT_EQ(e.subframes, 5);
  EXPECT_EQ(e.brightness_drift, 0.4);
  EXPECT_EQ(e.white_balance_drift, 0.1);
  EXPECT_EQ(e.frame_drops, 0.05);
  EXPECT_EQ(e.time_offset, 0.004);
  EXPECT_EQ(e.calibration_error.rotation, 0.002);
  EXPECT_EQ(e.calibration_error.focal, -0.01);
  EXPECT_EQ(e.tracker, "paper");
}

TEST(SceneEyesTest, ErrorsNameWhatIsValid) {
  const auto eyes = [](const std::string& key) { return MessageOf("eyes:\n  " + key + "\n"); };
  EXPECT_THAT(eyes("width: 200"), AllOf(HasSubstr("scene.yaml:2"), HasSubstr("320")));
  EXPECT_THAT(eyes("height: 1081"), HasSubstr("1080"));
  EXPECT_THAT(eyes("distortion: [0.1, 0.2]"), HasSubstr("5 (k1 k2 p1 p2 k3)"));
  EXPECT_THAT(eyes("frame_drops: 1"), HasSubstr("0.9"));
  EXPECT_THAT(eyes("tracker: best"), AllOf(HasSubstr("outline"), HasSubstr("paper")));
  EXPECT_THAT(eyes("blur: 3"), AllOf(HasSubstr("blur"), HasSubstr("exposure")));
}

TEST(SceneDemonstratorTest, MayBeElsewhereFasterHiddenAndCluttered) {
  const SceneDemonstrator d = ParseScene(
                                  "demonstrator:\n  distance: 0.8\n  speed: 1.5\n"
                                  "  occlusion: {fingers: [index, pinkie], frames: 12}\n"
                                  "  clutter: 5\n",
                                  "s.yaml")
                                  .demonstrator;
  EXPECT_EQ(d.distance, 0.8);
  EXPECT_EQ(d.speed, 1.5);
  EXPECT_EQ(d.occlusion.fingers, (std::vector<int>{1, 4}));
  EXPECT_EQ(d.occlusion.frames, 12);
  EXPECT_EQ(d.clutter, 5);
  EXPECT_EQ(ParseScene("demonstrator: {clutter: true}\n", "s.yaml").demonstrator.clutter, 8);
  EXPECT_EQ(ParseScene("demonstrator: {clutter: false}\n", "s.yaml").demonstrator.clutter, 0);
  EXPECT_THAT(MessageOf("demonstrator: {occlusion: {fingers: [indx]}}\n"),
              AllOf(HasSubstr("indx"), HasSubstr("index")));
  EXPECT_THAT(MessageOf("demonstrator: {clutter: many}\n"), HasSubstr("many"));
  EXPECT_THAT(MessageOf("demonstrator: {speed: 0}\n"), HasSubstr("speed"));
}

}  // namespace
}  // namespace springgrasp
