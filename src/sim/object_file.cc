#include "sim/object_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "sim/mjcf_part.h"
#include "sim/model_index.h"
#include "sim/mujoco_handles.h"
#include "sim/obj_check.h"
#include "sim/object_mesh.h"

namespace springgrasp {
namespace {

using Kind = ObjectPart::Kind;

ModelPtr LoadMesh(const std::string& path) {
  CheckObj(path);
  const std::string file = std::filesystem::absolute(path);
  return LoadModelText(fmt::format("<mujoco><asset><mesh name='mesh' file='{}'/></asset><worldbody>"
                                   "<body><geom type='mesh' mesh='mesh'/></body></worldbody>"
                                   "</mujoco>",
                                   file),
                       path);
}

ModelPtr LoadObject(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".xml") return LoadMesh(path);
  const std::unique_ptr<XmlDocument> part = ReadMjcfPart(path, "object");
  const XmlElement* world = part->FirstChildElement("mujoco")->FirstChildElement("worldbody");
  const XmlElement* body = world == nullptr ? nullptr : world->FirstChildElement("body");
  ThrowUnless(body != nullptr && body->NextSiblingElement("body") == nullptr,
              "{}: expected exactly one body in the world of an object file", path);
  const XmlElement* asset = part->FirstChildElement("mujoco")->FirstChildElement("asset");
  for (const XmlElement* mesh = asset == nullptr ? nullptr : asset->FirstChildElement("mesh");
       mesh != nullptr; mesh = mesh->NextSiblingElement("mesh")) {
    if (mesh->Attribute("file") != nullptr) CheckObj(mesh->Attribute("file"));
  }
  return LoadModelFile(path);
}

Kind KindOf(int geom_type, const std::string& path) {
  switch (geom_type) {
    case mjGEOM_SPHERE:
      return Kind::kSphere;
    case mjGEOM_CAPSULE:
      return Kind::kCapsule;
    case mjGEOM_CYLINDER:
      return Kind::kCylinder;
    case mjGEOM_ELLIPSOID:
      return Kind::kEllipsoid;
    case mjGEOM_BOX:
      return Kind::kBox;
    case mjGEOM_MESH:
      return Kind::kMesh;
    default:
      Fail("{}: a part of an object must be a sphere, capsule, cylinder, ellipsoid, box or mesh",
           path);
  }
}

ObjectPart PartOf(const mjModel& model, int geom, const Pose& X_OP, const std::string& path) {
  ObjectPart part;
  part.kind = KindOf(model.geom_type[geom], path);
  part.size = Vector3From(model.geom_size + 3 * geom);
  part.X_OP = X_OP;
  if (part.kind != Kind::kMesh) return part;
  const int mesh = model.geom_dataid[geom];
  const float* v = model.mesh_vert + 3 * model.mesh_vertadr[mesh];
  for (int i = 0; i < model.mesh_vertnum[mesh]; ++i, v += 3) {
    part.vertices.emplace_back(v[0], v[1], v[2]);
  }
  return part;
}

// Support function of one part about its own origin, direction in its own frame.
double Support(const ObjectPart& part, const Eigen::Vector3d& d) {
  switch (part.kind) {
    case Kind::kSphere:
      return part.size.x();
    case Kind::kCapsule:
      return part.size.x() + part.size.y() * std::abs(d.z());
    case Kind::kCylinder:
      return part.size.x() * d.head<2>().norm() + part.size.y() * std::abs(d.z());
    case Kind::kEllipsoid:
      return part.size.cwiseProduct(d).norm();
    case Kind::kBox:
      return part.size.dot(d.cwiseAbs());
    case Kind::kMesh:
      break;
  }
  double most = -1e300;
  for (const Eigen::Vector3d& v : part.vertices) most = std::max(most, v.dot(d));
  return most;
}

}  // namespace

ObjectFile ReadObjectFile(const std::string& path) {
  const ModelPtr model = LoadObject(path);
  const DataPtr data = MakeData(*model);
  mj_kinematics(model.get(), data.get());
  const Pose X_WO = PoseFromXmat(data->xpos + 3, data->xmat + 9);
  ObjectFile file;
  file.mass = model->body_subtreemass[1];
  file.friction = 1e300;
  for (int g = 0; g < model->ngeom; ++g) {
    if (model->geom_bodyid[g] == 0 || (model->geom_contype[g] | model->geom_conaffinity[g]) == 0) {
      continue;
    }
    const Pose X_WP = PoseFromXmat(data->geom_xpos + 3 * g, data->geom_xmat + 9 * g);
    file.parts.push_back(PartOf(*model, g, X_WO.inverse() * X_WP, path));
    file.friction = std::min(file.friction, model->geom_friction[3 * g]);
  }
  ThrowUnless(!file.parts.empty(), "{}: nothing of the object can be touched, expected a geom",
              path);
  ThrowUnless(file.mass > 0, "{}: the object has no mass, expected mass or density of its geoms",
              path);
  return file;
}

TriangleMesh ReadObjectMesh(const std::string& path) {
  const ModelPtr model = LoadObject(path);
  const DataPtr data = MakeData(*model);
  mj_kinematics(model.get(), data.get());
  const Pose X_WO = PoseFromXmat(data->xpos + 3, data->xmat + 9);
  TriangleMesh out;
  for (int g = 0; g < model->ngeom; ++g) {
    if (model->geom_bodyid[g] == 0 || (model->geom_contype[g] | model->geom_conaffinity[g]) == 0) {
      continue;
    }
    ThrowUnless(model->geom_type[g] == mjGEOM_MESH,
                "{}: a part of the object is no mesh; give a primitive as sphere:D, cylinder:DxH "
                "or box:XxYxZ",
                path);
    const Pose X_WP = PoseFromXmat(data->geom_xpos + 3 * g, data->geom_xmat + 9 * g);
    const Pose X_OP = X_WO.inverse() * X_WP;
    const int mesh = model->geom_dataid[g];
    const int first = static_cast<int>(out.vertices.size());
    const float* v = model->mesh_vert + 3 * model->mesh_vertadr[mesh];
    for (int i = 0; i < model->mesh_vertnum[mesh]; ++i, v += 3) {
      out.vertices.push_back(X_OP * Eigen::Vector3d(v[0], v[1], v[2]));
    }
    const int* f = model->mesh_face + 3 * model->mesh_faceadr[mesh];
    for (int i = 0; i < model->mesh_facenum[mesh]; ++i, f += 3) {
      out.faces.push_back({first + f[0], first + f[1], first + f[2]});
    }
  }
  ThrowUnless(!out.faces.empty(), "{}: nothing of the object can be touched, expected a mesh",
              path);
  return out;
}

double ReachOf(const std::vector<ObjectPart>& parts, const Eigen::Vector3d& direction_O) {
  if (parts.empty()) return 0;
  double most = -1e300;
  for (const ObjectPart& part : parts) {
    const Eigen::Vector3d d = part.X_OP.linear().transpose() * direction_O;
    most = std::max(most, part.X_OP.translation().dot(direction_O) + Support(part, d));
  }
  return most;
}

}  // namespace springgrasp
