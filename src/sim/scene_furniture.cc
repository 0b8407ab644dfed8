#include "sim/scene_furniture.h"

#include <cmath>
#include <filesystem>

#include "base/error.h"

namespace springgrasp {
namespace {

template <typename Vector>
std::string Text(const Vector& v) {
  return fmt::format("{}", fmt::join(v.begin(), v.end(), " "));
}

void Set(XmlElement* element, const char* key, const std::string& value) {
  element->SetAttribute(key, value.c_str());
}

XmlElement* Add(XmlElement* parent, const char* element, const std::string& name) {
  XmlElement* e = parent->InsertNewChildElement(element);
  if (!name.empty()) Set(e, "name", name);
  return e;
}

void SetPose(XmlElement* element, const Pose& X) {
  const Eigen::Matrix<double, 7, 1> p = PoseToArray(X);
  Set(element, "pos", fmt::format("{} {} {}", p[0], p[1], p[2]));
  Set(element, "quat", fmt::format("{} {} {} {}", p[3], p[4], p[5], p[6]));
}

Pose YawPose(double x, double y, double z, double yaw) {
  return MakePose({x, y, z}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())));
}

void SetColour(XmlElement* geom, const Eigen::Vector3d& rgb) {
  Set(geom, "rgba", Text(rgb) + " 1");
}

void SetShape(XmlElement* geom, const Shape& shape) {
  const Eigen::Vector3d half = shape.size / 2;
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      Set(geom, "type", "sphere");
      Set(geom, "size", fmt::format("{}", half.x()));
      return;
    case Shape::Kind::kCylinder:
      Set(geom, "type", "cylinder");
      Set(geom, "size", fmt::format("{} {}", half.x(), half.z()));
      return;
    case Shape::Kind::kBox:
      break;
  }
  Set(geom, "type", "box");
  Set(geom, "size", Text(half));
}

// The object's own contact parameters hold in all its contacts (priority).
void SetContact(XmlElement* geom, double friction, const ScenePhysics& physics, int priority) {
  Set(geom, "friction",
      fmt::format("{} {} {}", friction, physics.torsional_friction, physics.rolling_friction));
  geom->SetAttribute("condim", physics.condim);
  geom->SetAttribute("priority", priority);
  Set(geom, "solref", Text(physics.solref));
  Set(geom, "solimp", Text(physics.solimp));
}

// Body of an MJCF object file: renamed and freed. All its names begin with the object's, so that
// several objects may come from one file.
void AddFileObject(const SceneObject& object, const Pose& X_WO, XmlDocument& document) {
  const std::unique_ptr<XmlDocument> part = ReadMjcfPart(object.model, object.name);
  XmlElement* world = ChildOf(part->FirstChildElement("mujoco"), "worldbody");
  XmlElement* body = world->FirstChildElement("body");
  ThrowUnless(body != nullptr && body->NextSiblingElement("body") == nullptr,
              "{}: expected exactly one body in the world of an object file", object.model);
  PrefixNames(*part, object.name);
  Set(body, "name", object.name);
  for (const char* key : {"axisangle", "xyaxes", "zaxis", "euler"}) body->DeleteAttribute(key);
  SetPose(body, X_WO);
  for (const char* joint : {"joint", "freejoint"}) {
    while (XmlElement* j = body->FirstChildElement(joint)) body->DeleteChild(j);
  }
  Add(body, "freejoint", object.name + "_free");
  MergeMjcfPart(*part, document);
}

}  // namespace

void MakeIntangible(XmlElement* element) {
  for (XmlElement* e = element->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    if (std::string(e->Name()) == "geom") {
      e->SetAttribute("contype", 0);
      e->SetAttribute("conaffinity", 0);
    }
    MakeIntangible(e);
  }
}

void AddSettings(const Scene& scene, int offscreen_samples, XmlElement* root) {
  const ScenePhysics& p = scene.physics;
  XmlElement* compiler = ChildOf(root, "compiler");
  Set(compiler, "angle", "radian");
  Set(compiler, "autolimits", "true");
  XmlElement* option = ChildOf(root, "option");
  Set(option, "timestep", fmt::format("{}", p.timestep));
  Set(option, "integrator", p.integrator);
  Set(option, "solver", p.solver);
  option->SetAttribute("iterations", p.iterations);
  Set(option, "cone", p.cone);
  Set(option, "impratio", fmt::format("{}", p.impratio));
  option->SetAttribute("noslip_iterations", p.noslip_iterations);
  // Its measure of progress is relative to the mean inertia: a platform of 100 kg would end it
  // after the first iteration, and light objects creep.
  Set(option, "noslip_tolerance", "0");
  // Without it a cylinder stands on one wandering contact point and trembles.
  Set(ChildOf(option, "flag"), "multiccd", "enable");
  XmlElement* size = ChildOf(root, "size");
  size->SetAttribute("njmax", 1000);
  size->SetAttribute("nconmax", 200);
  // Fixed extent and centre: clipping planes must not depend on where the objects stand.
  XmlElement* statistic = ChildOf(root, "statistic");
  Set(statistic, "extent", "2");
  Set(statistic, "center", "0.2 0.4 1");
  XmlElement* visual = ChildOf(root, "visual");
  XmlElement* global = ChildOf(visual, "global");
  global->SetAttribute("offwidth", 1920);
  global->SetAttribute("offheight", 1440);
  XmlElement* quality = ChildOf(visual, "quality");
  quality->SetAttribute("offsamples", offscreen_samples);
  quality->SetAttribute("shadowsize", 1024);
  quality->SetAttribute("numslices", 20);
  quality->SetAttribute("numstacks", 12);
  XmlElement* map = ChildOf(visual, "map");
  Set(map, "znear", "0.01");
  Set(map, "zfar", "10");
  Set(map, "shadowclip", "0.6");
  XmlElement* headlight = ChildOf(visual, "headlight");
  Set(headlight, "ambient", "0.32 0.32 0.32");
  Set(headlight, "diffuse", "0.3 0.3 0.3");
  Set(headlight, "specular", "0 0 0");
}

void AddSurroundings(const Scene& scene, XmlElement* root) {
  XmlElement* asset = ChildOf(root, "asset");
  XmlElement* sky = Add(asset, "texture", "sky");
  Set(sky, "type", "skybox");
  Set(sky, "builtin", "gradient");
  Set(sky, "rgb1", "0.86 0.88 0.91");
  Set(sky, "rgb2", "0.62 0.66 0.72");
  sky->SetAttribute("width", 64);
  sky->SetAttribute("height", 384);
  XmlElement* tiles = Add(asset, "texture", "floor");
  Set(tiles, "type", "2d");
  Set(tiles, "builtin", "checker");
  Set(tiles, "rgb1", "0.52 0.54 0.57");
  Set(tiles, "rgb2", "0.47 0.49 0.52");
  tiles->SetAttribute("width", 256);
  tiles->SetAttribute("height", 256);
  XmlElement* material = Add(asset, "material", "floor");
  Set(material, "texture", "floor");
  Set(material, "texrepeat", "2 2");
  Set(material, "texuniform", "true");
  material->SetAttribute("specular", 0);

  XmlElement* world = ChildOf(root, "worldbody");
  XmlElement* floor = Add(world, "geom", "floor");
  Set(floor, "type", "plane");
  Set(floor, "size", "6 6 0.1");
  Set(floor, "material", "floor");
  for (const SceneLight& l : scene.lights) {
    XmlElement* light = Add(world, "light", "");
    Set(light, "pos", Text(l.position));
    Set(light, "dir", Text(Eigen::Vector3d((l.lookat - l.position).normalized())));
    Set(light, "diffuse", fmt::format("{0} {0} {0}", l.brightness));
    Set(light, "specular", "0.1 0.1 0.1");
    Set(light, "directional", "true");
    Set(light, "castshadow", l.shadow ? "true" : "false");
  }
  for (const SceneCamera& c : scene.cameras) {
    const Eigen::Vector3d forward = (c.lookat - c.position).normalized();
    const Eigen::Vector3d up_hint =
        std::abs(forward.z()) > 0.999 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d right = forward.cross(up_hint).normalized();
    const Eigen::Vector3d up = right.cross(forward);
    XmlElement* camera = Add(world, "camera", c.name);
    Set(camera, "pos", Text(c.position));
    Set(camera, "xyaxes", Text(right) + " " + Text(up));
    Set(camera, "fovy", fmt::format("{}", c.fovy_deg));
  }
}

void AddTable(const Scene& scene, XmlElement* root) {
  const SceneTable& t = scene.table;
  XmlElement* body = Add(ChildOf(root, "worldbody"), "body", "table");
  SetPose(body, YawPose(t.position.x(), t.position.y(), t.height, t.yaw));
  XmlElement* top = Add(body, "geom", "table");
  Set(top, "type", "box");
  Set(top, "size", Text(Eigen::Vector3d(t.size / 2)));
  Set(top, "pos", fmt::format("0 0 {}", -t.size.z() / 2));
  SetColour(top, {0.72, 0.75, 0.78});
  SetContact(top, 0.9, scene.physics, 0);
  constexpr double kLeg = 0.02;  // m, half width
  const double half = (t.height - t.size.z()) / 2;
  for (int i = 0; i < 4 && half > 0; ++i) {
    XmlElement* leg = Add(body, "geom", "");
    const double x = (i % 2 == 0 ? 1 : -1) * (t.size.x() / 2 - kLeg);
    const double y = (i / 2 == 0 ? 1 : -1) * (t.size.y() / 2 - kLeg);
    Set(leg, "type", "box");
    Set(leg, "size", fmt::format("{0} {0} {1}", kLeg, half));
    Set(leg, "pos", fmt::format("{} {} {}", x, y, -t.size.z() - half));
    SetColour(leg, {0.45, 0.47, 0.5});
    leg->SetAttribute("contype", 0);
    leg->SetAttribute("conaffinity", 0);
  }
}

void AddRing(const Scene& scene, int object, XmlElement* root) {
  const SceneObject& o = scene.objects.at(object);
  const std::optional<RingSeat> seat = SeatOnRing(o);
  if (!o.on_ring || !seat) return;
  const Ring& ring = seat->ring;
  const Pose X_WO = ObjectStartPose(scene, object);
  const double bottom = X_WO.translation().z() - seat->height;
  XmlElement* body = Add(ChildOf(root, "worldbody"), "body", o.name + "_ring");
  SetPose(body, YawPose(X_WO.translation().x(), X_WO.translation().y(), bottom, 0));
  const auto corner = [&](int i) {
    const double angle = 2 * M_PI * i / ring.segments;
    return fmt::format("{} {} {}", ring.radius * std::cos(angle), ring.radius * std::sin(angle),
                       ring.tube);
  };
  for (int i = 0; i < ring.segments; ++i) {
    XmlElement* capsule = Add(body, "geom", fmt::format("{}_ring_{}", o.name, i));
    Set(capsule, "type", "capsule");
    Set(capsule, "fromto", corner(i) + " " + corner(i + 1));
    Set(capsule, "size", fmt::format("{}", ring.tube));
    SetColour(capsule, {0.25, 0.27, 0.3});
    SetContact(capsule, o.friction, scene.physics, 0);
  }
  const double stand = bottom - scene.table.height;
  if (stand <= 1e-3) return;
  XmlElement* post = Add(body, "geom", o.name + "_ring_stand");
  Set(post, "type", "cylinder");
  Set(post, "size", fmt::format("{} {}", ring.radius, stand / 2));
  Set(post, "pos", fmt::format("0 0 {}", -stand / 2));
  SetColour(post, {0.35, 0.37, 0.4});
  SetContact(post, o.friction, scene.physics, 0);
}

void AddPedestal(const Scene& scene, int object, XmlElement* root) {
  const SceneObject& o = scene.objects.at(object);
  if (o.pedestal.z() <= 0) return;
  const Eigen::Vector3d p_WO = ObjectStartPose(scene, object).translation();
  const double middle = scene.table.height + o.pedestal.z() / 2;
  XmlElement* body = Add(ChildOf(root, "worldbody"), "body", o.name + "_pedestal");
  SetPose(body, YawPose(p_WO.x(), p_WO.y(), middle, o.yaw));
  XmlElement* block = Add(body, "geom", o.name + "_pedestal");
  Set(block, "type", "box");
  Set(block, "size", Text(Eigen::Vector3d(o.pedestal / 2)));
  SetColour(block, {0.35, 0.37, 0.4});
  SetContact(block, o.friction, scene.physics, 0);
}

void AddSlot(const Scene& scene, int object, XmlElement* root) {
  constexpr double kJaw = 0.008, kPlay = 0.0004;  // m: thickness of a jaw, room beside the plate
  const SceneObject& o = scene.objects.at(object);
  if (o.slot <= 0 || !o.shape) return;
  const Eigen::Vector3d p_WO = ObjectStartPose(scene, object).translation();
  const double bottom = scene.table.height + o.pedestal.z();
  const int thin = o.shape->size.x() < o.shape->size.y() ? 0 : 1;
  XmlElement* body = Add(ChildOf(root, "worldbody"), "body", o.name + "_slot");
  SetPose(body, YawPose(p_WO.x(), p_WO.y(), bottom + o.slot / 2, o.yaw));
  Eigen::Vector3d half(0.25 * o.shape->size.x(), 0.25 * o.shape->size.y(), o.slot / 2);
  half[thin] = kJaw / 2;
  for (const int side : {-1, 1}) {
    XmlElement* jaw = Add(body, "geom", fmt::format("{}_slot_{}", o.name, side < 0 ? 0 : 1));
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    middle[thin] = side * (o.shape->size[thin] / 2 + kPlay + kJaw / 2);
    Set(jaw, "type", "box");
    Set(jaw, "size", Text(half));
    Set(jaw, "pos", Text(middle));
    SetColour(jaw, {0.25, 0.27, 0.3});
    SetContact(jaw, o.friction, scene.physics, 0);
  }
}

void AddObject(const Scene& scene, int object, XmlDocument& document) {
  const SceneObject& o = scene.objects.at(object);
  const Pose X_WO = ObjectStartPose(scene, object);
  XmlElement* root = document.FirstChildElement("mujoco");
  if (std::filesystem::path(o.model).extension() == ".xml") {
    AddFileObject(o, X_WO, document);
    return;
  }
  XmlElement* body = Add(ChildOf(root, "worldbody"), "body", o.name);
  SetPose(body, X_WO);
  Add(body, "freejoint", o.name + "_free");
  XmlElement* geom = Add(body, "geom", o.name);
  if (o.model.empty() && o.shape) {
    SetShape(geom, *o.shape);
  } else {
    XmlElement* mesh = Add(ChildOf(root, "asset"), "mesh", o.name);
    Set(mesh, "file", o.model);
    Set(geom, "type", "mesh");
    Set(geom, "mesh", o.name);
  }
  Set(geom, "mass", fmt::format("{}", o.mass));
  SetColour(geom, o.colour);
  SetContact(geom, o.friction, scene.physics, 1);
}

void AddShownObject(const Shape& shape, const Scene& scene, XmlElement* root) {
  XmlElement* body = Add(ChildOf(root, "worldbody"), "body", "shown_object");
  body->SetAttribute("mocap", true);
  XmlElement* geom = Add(body, "geom", "shown_object");
  SetShape(geom, shape);
  SetColour(geom, scene.objects.empty() ? Eigen::Vector3d(0.3, 0.4, 0.8) : scene.objects[0].colour);
  MakeIntangible(body);
}

}  // namespace springgrasp
