#include "sim/model_index.h"

#include "base/error.h"

namespace springgrasp {
namespace {

int CountOf(const mjModel& model, mjtObj type) {
  switch (type) {
    case mjOBJ_BODY:
      return model.nbody;
    case mjOBJ_JOINT:
      return model.njnt;
    case mjOBJ_GEOM:
      return model.ngeom;
    case mjOBJ_SITE:
      return model.nsite;
    case mjOBJ_CAMERA:
      return model.ncam;
    case mjOBJ_LIGHT:
      return model.nlight;
    case mjOBJ_ACTUATOR:
      return model.nu;
    case mjOBJ_SENSOR:
      return model.nsensor;
    case mjOBJ_TENDON:
      return model.ntendon;
    case mjOBJ_EQUALITY:
      return model.neq;
    case mjOBJ_KEY:
      return model.nkey;
    case mjOBJ_MESH:
      return model.nmesh;
    case mjOBJ_MATERIAL:
      return model.nmat;
    default:
      Fail("no names for MuJoCo object type {}", static_cast<int>(type));
  }
}

}  // namespace

int FindId(const mjModel& model, mjtObj type, const std::string& name) {
  return mj_name2id(&model, type, name.c_str());
}

int IdOf(const mjModel& model, mjtObj type, const std::string& name) {
  const int id = FindId(model, type, name);
  ThrowUnless(id >= 0, "the model has no {} named '{}', expected one of {}", mju_type2Str(type),
              name, fmt::join(NamesOf(model, type), ", "));
  return id;
}

std::string NameOf(const mjModel& model, mjtObj type, int id) {
  const char* name = id < 0 ? nullptr : mj_id2name(&model, type, id);
  return name == nullptr ? "" : name;
}

std::vector<std::string> NamesOf(const mjModel& model, mjtObj type) {
  std::vector<std::string> names;
  for (int id = 0; id < CountOf(model, type); ++id) names.push_back(NameOf(model, type, id));
  return names;
}

Eigen::Vector3d Vector3From(const mjtNum* v) { return {v[0], v[1], v[2]}; }

Pose PoseFromXmat(const mjtNum* pos, const mjtNum* mat) {
  Pose X = Pose::Identity();
  X.translation() = Vector3From(pos);
  X.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(mat);
  return X;
}

Pose PoseFromQuat(const mjtNum* pos, const mjtNum* quat) {
  return MakePose(Vector3From(pos), Eigen::Quaterniond(quat[0], quat[1], quat[2], quat[3]));
}

Pose BodyPose(const mjModel& model, const mjData& data, const std::string& body) {
  const int id = IdOf(model, mjOBJ_BODY, body);
  return PoseFromXmat(data.xpos + 3 * id, data.xmat + 9 * id);
}

Pose SitePose(const mjModel& model, const mjData& data, const std::string& site) {
  const int id = IdOf(model, mjOBJ_SITE, site);
  return PoseFromXmat(data.site_xpos + 3 * id, data.site_xmat + 9 * id);
}

}  // namespace springgrasp
