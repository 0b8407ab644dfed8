#include "sim/scene.h"

#include <cmath>

#include "base/error.h"
#include "sim/ring.h"

namespace springgrasp {

int ObjectIndex(const Scene& scene, const std::string& name) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    if (scene.objects[i].name == name) return static_cast<int>(i);
    names.push_back(scene.objects[i].name);
  }
  Fail("{}: no object named '{}', expected one of {}", scene.source, name, fmt::join(names, ", "));
}

Pose ObjectStartPose(const Scene& scene, int object) {
  const SceneObject& o = scene.objects.at(object);
  Pose X_WO = o.X_WO;
  X_WO.linear() =
      Eigen::AngleAxisd(o.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix() * X_WO.linear();
  if (!o.resting) return X_WO;
  double z = o.shape ? o.shape->size.z() / 2 : 0;
  if (o.on_ring && o.shape) z = o.ring_height + SphereHeightOnRing(o.shape->size.x());
  X_WO.translation().z() = scene.table.height + z;
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
