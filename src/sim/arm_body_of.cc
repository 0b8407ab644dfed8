#include "sim/arm_body_of.h"

#include <algorithm>
#include <map>
#include <string>

#include "sim/model_index.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

Pose PoseOfBody(const mjData& data, int body) {
  return PoseFromQuat(data.xpos + 3 * body, data.xquat + 4 * body);
}

// Pose of a shape in the world.
Pose PoseOfGeom(const mjModel& model, const mjData& data, int geom) {
  return PoseOfBody(data, model.geom_bodyid[geom]) *
         PoseFromQuat(model.geom_pos + 3 * geom, model.geom_quat + 4 * geom);
}

// A round shape as a capsule of the same place (a cylinder's reaches beyond its ends); a box as the
// capsule along its longest side that holds most of it.
BodyCapsule CapsuleOf(const mjModel& model, int geom, const Pose& X) {
  const mjtNum* size = model.geom_size + 3 * geom;
  BodyCapsule capsule;
  Vector3d half = Vector3d::Zero();
  switch (model.geom_type[geom]) {
    case mjGEOM_SPHERE:
      capsule.radius = size[0];
      break;
    case mjGEOM_BOX: {
      const Vector3d sides(size[0], size[1], size[2]);
      int longest = 0;
      const double most = sides.maxCoeff(&longest);
      capsule.radius = 0.5 * (sides.sum() - most);
      half[longest] = std::max(0.0, most - capsule.radius);
      break;
    }
    default:
      capsule.radius = size[0];
      half.z() = size[1];
  }
  capsule.a = X * Vector3d(-half);
  capsule.b = X * half;
  return capsule;
}

bool Excluded(const mjModel& model, int a, int b) {
  const int wa = model.body_weldid[a], wb = model.body_weldid[b];
  if (wa == wb || model.body_weldid[model.body_parentid[wa]] == wb ||
      model.body_weldid[model.body_parentid[wb]] == wa) {
    return true;
  }
  for (int i = 0; i < model.nexclude; ++i) {
    const int low = model.exclude_signature[i] >> 16, high = model.exclude_signature[i] & 0xFFFF;
    if ((low == a && high == b) || (low == b && high == a)) return true;
  }
  return false;
}

}  // namespace

ArmBody ArmBodyOf(const Arm& arm, const mjModel& model, const mjData& data) {
  std::map<std::string, int> node_of;
  for (std::size_t n = 0; n < arm.tree.nodes.size(); ++n) {
    node_of[arm.tree.nodes[n].name] = static_cast<int>(n);
  }
  // The bodies of the first two joints turn in place beside the chest, by design without touching.
  constexpr int kInPlace = 2;
  const auto body_of = [&](int joint) {
    return model.jnt_bodyid[IdOf(model, mjOBJ_JOINT, arm.tree.joint_names[arm.joints[joint]])];
  };
  const int first = body_of(kInPlace);
  const auto root_of = [&](int body) {
    while (body > 0 && model.body_parentid[body] > 0) body = model.body_parentid[body];
    return body;
  };
  // The tree's node that a body moves with; -1: not moved by the arm.
  const auto node_that_moves = [&](int body) {
    int node = -1;
    for (int b = body; b > 0; b = model.body_parentid[b]) {
      const auto found = node_of.find(NameOf(model, mjOBJ_BODY, b));
      if (node < 0 && found != node_of.end()) node = found->second;
      if (b == first) return node;
    }
    return -1;
  };
  ArmBody result;
  std::vector<int> link_body, rest_body, block_body;
  for (int g = 0; g < model.ngeom; ++g) {
    const int body = model.geom_bodyid[g];
    if (model.geom_contype[g] == 0 && model.geom_conaffinity[g] == 0) continue;
    if (root_of(body) != root_of(first)) continue;
    const int type = model.geom_type[g];
    if (type != mjGEOM_SPHERE && type != mjGEOM_CAPSULE && type != mjGEOM_CYLINDER &&
        type != mjGEOM_BOX) {
      continue;
    }
    const int node = node_that_moves(body);
    bool in_place = false;
    for (int i = 0; i < kInPlace; ++i) in_place = in_place || body == body_of(i);
    if (in_place) continue;
    const Pose X_WG = PoseOfGeom(model, data, g);
    if (node >= 0) {
      int b = body;
      while (node_of.find(NameOf(model, mjOBJ_BODY, b)) == node_of.end())
        b = model.body_parentid[b];
      BodyCapsule capsule = CapsuleOf(model, g, PoseOfBody(data, b).inverse() * X_WG);
      capsule.node = node;
      result.links.push_back(capsule);
      link_body.push_back(body);
    } else if (type == mjGEOM_BOX || type == mjGEOM_CYLINDER) {
      ArmBody::Block block;
      block.X_WO = X_WG;
      const mjtNum* size = model.geom_size + 3 * g;
      if (type == mjGEOM_BOX) {
        block.shape.kind = Shape::Kind::kBox;
        block.shape.size = 2 * Vector3d(size[0], size[1], size[2]);
      } else {
        block.shape.kind = Shape::Kind::kCylinder;
        block.shape.size = 2 * Vector3d(size[0], size[0], size[1]);
      }
      result.blocks.push_back(block);
      block_body.push_back(body);
    } else {
      result.rest.push_back(CapsuleOf(model, g, X_WG));
      rest_body.push_back(body);
    }
  }
  for (const int link : link_body) {
    for (const int other : rest_body) {
      result.exempt_rest.push_back(Excluded(model, link, other));
    }
    for (const int other : block_body) {
      result.exempt_blocks.push_back(Excluded(model, link, other));
    }
  }
  return result;
}

}  // namespace springgrasp
