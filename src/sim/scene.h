// SCENE: what is there. Robot, table, objects, light, cameras, demonstrator, physics. YAML keys
// are the field names; unknown keys and values out of range are errors with file and line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "base/random.h"
#include "base/shape.h"
#include "sim/object_file.h"
#include "sim/pneumatics.h"
#include "sim/ring.h"
#include "sim/scene_eyes.h"

namespace springgrasp {

struct SceneTable {
  double height = 0.9;                   // m, of the top above the floor
  Eigen::Vector3d size{0.6, 0.5, 0.03};  // m: x, y, thickness
  Eigen::Vector2d position{0.35, 0.65};  // m, centre of the top in W (YAML: [x, y])
  double yaw = 0;                        // rad
};

// Half-ranges of a uniform draw about the given pose.
struct ScenePoseNoise {
  double x = 0, y = 0;  // m
  double yaw = 0;       // rad
};

// What the robot wrongly believes of an object: believed = truth + error (size, mass and
// friction: truth * (1 + error)).
struct SceneBelief {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  double yaw = 0;                                      // rad, about W's z
  double size = 0, mass = 0, friction = 0;             // fractions
};

struct SceneObject {
  std::string name = "object";
  std::optional<Shape> shape;  // shape: "cylinder:0.05x0.16" ...
  // ... or an MJCF (.xml) or mesh (.obj, .stl) file. With both, the file is what there is, and the
  // shape, about the same origin, what the robot takes it for.
  std::string model;
  // Of an .xml file that the scene does not overrule: as the file says.
  double mass = 0.1;              // kg
  double friction = 0.9;          // sliding coefficient, of all its contacts
  bool friction_of_file = false;  // every part of the file keeps its own, `friction` is the least
  std::vector<ObjectPart> parts;  // where the file is solid
  Pose X_WO = Pose::Identity();   // YAML pose: [x, y], [x, y, z] or x y z qw qx qy qz
  bool resting = true;            // z was not given: stands on the table, its ring or pedestal
  double yaw = 0;                 // rad, beside a pose of two or three numbers
  ScenePoseNoise pose_noise;
  bool on_ring = false;    // round ones (SeatOnRing): lie on a small fixed ring
  double ring_height = 0;  // m, from the table to the ring's bottom (a thin stand)
  // Width, depth and height of a fixed block on the table on which it stands (m); zero: none.
  Eigen::Vector3d pedestal = Eigen::Vector3d::Zero();
  double slot = 0;  // m, depth of a fixed slot that holds an upright plate (a box); 0: none
  // x, y in W where it shall be set down on the table once it was held (m); absent: it is not.
  std::optional<Eigen::Vector2d> place;
  Eigen::Vector3d colour{0.8, 0.25, 0.2};  // red, green, blue, 0..1
  SceneBelief believed;
};

struct SceneLight {
  Eigen::Vector3d position{0, 0, 3};
  Eigen::Vector3d lookat{0.35, 0.6, 0.9};
  double brightness = 0.5;  // diffuse, 0..1
  bool shadow = false;      // only seen by the pretty renderer
};

// An overview camera for videos and pictures.
struct SceneCamera {
  std::string name;
  Eigen::Vector3d position{0, 0, 0};
  Eigen::Vector3d lookat{0, 0, 0};
  double fovy_deg = 40;
};

// A plate that follows a cap on its way to the eyes, for a while in mid-movement.
struct SceneOcclusion {
  std::vector<int> fingers;  // 0 to 4 (YAML: names); none: off
  int frames = 15;           // for how long
};

// Who shows the grasp, and what the eyes see of it.
struct SceneDemonstrator {
  std::string kind = "synthesised";  // synthesised | recorded
  std::string type = "pinch";        // pinch | tripod | power | lateral
  std::string approach = "usual";    // synthesised: usual | side | above (GraspStyle)
  std::string file;                  // recorded: demonstration CSV
  std::optional<Shape> object;       // the object shown; absent: shape of the scene's first
  bool object_visible = true;        // the object is in the picture
  std::optional<Pose> X_WO;          // where the shown object stands (YAML: pose); absent:
                                     // chosen in the display volume before the eyes
  double hand_length = 0.189;        // m
  int fps = 30;                      // of the eyes, Hz
  std::optional<double> distance;    // m, the path's middle before the eyes; absent: 0.5 to 0.7
  std::optional<double> speed;       // m/s, the wrist's peak; absent: as performed
  SceneOcclusion occlusion;
  int clutter = 0;  // things behind and beside the hand
  // Absent: as in the model of the hand. Colours are red, green, blue, 0..1.
  std::optional<double> cap_diameter;  // m
  std::optional<Eigen::Vector3d> cap_colour;
  std::optional<Eigen::Vector3d> skin_colour;
};

struct ScenePhysics {
  double timestep = 0.002;           // s
  std::string integrator = "Euler";  // Euler | implicit
  std::string solver = "Newton";     // Newton | CG | PGS
  int iterations = 50;
  std::string cone = "elliptic";  // elliptic | pyramidal
  double impratio = 10;
  int noslip_iterations = 0;
  int condim = 4;                     // of objects: 3, 4 or 6
  double torsional_friction = 0.005;  // m
  double rolling_friction = 0.0001;   // m
  std::vector<double> solref{0.01, 1};
  std::vector<double> solimp{0.95, 0.99, 0.001};
};

struct Scene {
  std::string source;                         // file, for messages
  std::string robot = "armar3b/armar3b.xml";  // relative to models/, or absolute
  // documented | opposition: then the file <robot>_opposition.xml beside the robot's
  std::string hand = "documented";
  std::vector<std::string> active = {"right_arm", "right_hand"};
  std::map<std::string, double> start;  // joint -> rad; others 0 (within range)
  std::string torso = "fixed";          // fixed | free
  SceneTable table;
  std::vector<SceneObject> objects;
  double max_finger_force = 5;       // N
  std::vector<SceneLight> lights;    // default: two
  std::vector<SceneCamera> cameras;  // default: front and close
  SceneDemonstrator demonstrator;
  SceneEyes eyes;
  ScenePhysics physics;
  PneumaticParameters pneumatics;
};

// Throws Error with file and line.
Scene ReadScene(const std::string& path);
Scene ParseScene(const std::string& yaml_text, const std::string& name);

// Index of the object of that name, or Error listing the names.
int ObjectIndex(const Scene& scene, const std::string& name);

// The ring that fits an object, and the height of the object's origin above the ring's bottom.
// Absent if it is neither a sphere nor a file whose parts are spheres on the z axis.
struct RingSeat {
  Ring ring;
  double height = 0;  // m
};
std::optional<RingSeat> SeatOnRing(const SceneObject& object);

// True pose of an object at the start: z and yaw resolved (on the table, on its ring).
Pose ObjectStartPose(const Scene& scene, int object);

// Moves every object by a draw of its pose_noise (x, y, yaw in this order, all three always
// drawn, so that conditions share their draws).
void DrawObjectPoses(Scene& scene, RandomEngine& engine);

// What the robot is told of an object: truth plus the believed errors. `shape` is absent for
// objects that are files.
struct BelievedObject {
  std::optional<Shape> shape;
  Pose X_WO = Pose::Identity();
  double mass = 0;
  double friction = 0;
};
BelievedObject BelieveObject(const Scene& scene, int object);

}  // namespace springgrasp
