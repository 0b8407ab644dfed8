#include "sim/scene.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace springgrasp {

int ObjectIndex(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].name == name) return static_cast<int>(i);
    names.push_back(scene.objects[i].name);
  }
  Fail("{}: no object named '{}', expected one of {}", scene.source, name, fmt::join(names, ", "));
}

std::optional<RingSeat> SeatOnRing(const SceneObject& object) {
  RingSeat seat;
  if (object.model.empty() && object.shape) {
    if (object.shape->kind != Shape::Kind::kSphere) return std::nullopt;
    seat.ring = RingForSphere(object.shape->size.x());
    seat.height = SphereHeightOnRing(seat.ring, object.shape->size.x() / 2);
    return seat;
  }
  double widest = 0;
  for (const ObjectPart& part : object.parts) {
    const bool on_axis = part.X_OP.translation().head<2>().norm() < 1e-6;
    if (part.kind != ObjectPart::Kind::kSphere || !on_axis) return std::nullopt;
    widest = std::max(widest, 2 * part.size.x());
  }
  if (object.parts.empty()) return std::nullopt;
  seat.ring = RingForSphere(widest);
  for (const ObjectPart& part : object.parts) {
    const double height = SphereHeightOnRing(seat.ring, part.size.x());
    seat.height = std::max(seat.height, height - part.X_OP.translation().z());
  }
  return seat;
}

Pose ObjectStartPose(const Scene& scene, int object) {
  const SceneObject& o = scene.objects.at(object);
  Pose X_WO = o.X_WO;
  X_WO.linear() =
      Eigen::AngleAxisd(o.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix() * X_WO.linear();
  if (!o.resting) return X_WO;
  double z = ReachOf(o.parts, -X_WO.linear().transpose() * Eigen::Vector3d::UnitZ());
  if (o.model.empty() && o.shape) z = o.shape->size.z() / 2;
  if (const auto seat = SeatOnRing(o); seat && o.on_ring) z = o.ring_height + seat->height;
  X_WO.translation().z() = scene.table.height + o.pedestal.z() + z;
  return X_WO;
}

void DrawObjectPoses(Scene& scene, RandomEngine& engine) {
  for (SceneObject& o : scene.objects) {
    const double x = Uniform(engine, -1, 1);
    const double y = Uniform(engine, -1, 1);
    const double yaw = Uniform(engine, -1, 1);
    o.X_WO.translation() += Eigen::Vector3d(x * o.pose_noise.x, y * o.pose_noise.y, 0);
    o.yaw += yaw * o.pose_noise.yaw;
  }
}

BelievedObject BelieveObject(const Scene& scene, int object) {
  const SceneObject& o = scene.objects.at(object);
  const SceneBelief& error = o.believed;
  BelievedObject believed;
  believed.shape = o.shape;
  if (believed.shape) believed.shape->size *= 1 + error.size;
  believed.X_WO = ObjectStartPose(scene, object);
  believed.X_WO.translation() += error.position;
  believed.X_WO.linear() =
      Eigen::AngleAxisd(error.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
      believed.X_WO.linear();
  believed.mass = o.mass * (1 + error.mass);
  believed.friction = o.friction * (1 + error.friction);
  return believed;
}

}  // namespace springgrasp
