#include "sim/contacts.h"

#include <algorithm>
#include <string_view>

#include "sim/model_index.h"

namespace springgrasp {
namespace {

bool StartsWith(std::string_view text, std::string_view prefix) {
  return text.substr(0, prefix.size()) == prefix;
}

bool EndsWith(std::string_view text, std::string_view suffix) {
  return text.size() >= suffix.size() && text.substr(text.size() - suffix.size()) == suffix;
}

// "hand_r_index_j1" -> index, 1. Leaves `role` alone for any other name.
void MatchFinger(std::string_view name, GeomRole& role) {
  if (!StartsWith(name, "hand_")) return;
  for (int f = 0; f < kNumFingers; ++f) {
    if (name.find(kFingerNames[f]) == std::string_view::npos) continue;
    for (int j = 0; j < 2; ++j) {
      if (EndsWith(name, j == 0 ? "_j0" : "_j1")) role = {GeomPart::kFinger, f, j};
    }
  }
}

// Role by one body's own names, without its parents; kOther if they say nothing.
GeomRole RoleOfBody(const mjModel& model, int body) {
  GeomRole role;
  const std::string name = NameOf(model, mjOBJ_BODY, body);
  for (int k = 0; k < model.body_jntnum[body]; ++k) {
    const int joint = model.body_jntadr[body] + k;
    if (model.jnt_type[joint] == mjJNT_FREE) return {GeomPart::kObject, -1, -1};
    MatchFinger(NameOf(model, mjOBJ_JOINT, joint), role);
  }
  if (role.part == GeomPart::kOther) MatchFinger(name, role);
  if (role.part != GeomPart::kOther) return role;
  if (name == "table") return {GeomPart::kTable, -1, -1};
  for (const char* seat : {"_ring", "_pedestal", "_slot"}) {
    if (EndsWith(name, seat)) return {GeomPart::kRing, -1, -1};
  }
  if (StartsWith(name, "hand_")) return {GeomPart::kPalm, -1, -1};
  if (StartsWith(name, "arm_")) return {GeomPart::kArm, -1, -1};
  return role;
}

}  // namespace

void ReadContacts(const mjModel& model, const mjData& data, std::vector<ContactPoint>& contacts) {
  contacts.resize(data.ncon);
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& c = data.contact[i];
    ContactPoint& out = contacts[i];
    out.geom1 = c.geom1;
    out.geom2 = c.geom2;
    out.body1 = model.geom_bodyid[c.geom1];
    out.body2 = model.geom_bodyid[c.geom2];
    out.p_W = Vector3From(c.pos);
    // MuJoCo's contact frame has its axes as rows.
    out.R_WC = Eigen::Map<const Eigen::Matrix3d>(c.frame);
    out.distance = c.dist;
    out.friction = c.friction[0];
    mjtNum wrench[6] = {0, 0, 0, 0, 0, 0};
    if (c.efc_address >= 0) mj_contactForce(&model, &data, i, wrench);
    out.normal_force = wrench[0];
    out.f_W = out.R_WC * Vector3From(wrench);
    out.torque_W = out.R_WC * Vector3From(wrench + 3);
  }
}

std::vector<GeomRole> ClassifyGeoms(const mjModel& model) {
  // Parents stand first, so that a nameless or odd body takes the role of its parent.
  std::vector<GeomRole> bodies(model.nbody);
  for (int b = 1; b < model.nbody; ++b) {
    bodies[b] = RoleOfBody(model, b);
    if (bodies[b].part == GeomPart::kOther) bodies[b] = bodies[model.body_parentid[b]];
  }
  std::vector<GeomRole> roles(model.ngeom);
  for (int g = 0; g < model.ngeom; ++g) {
    roles[g] = bodies[model.geom_bodyid[g]];
    if (model.geom_type[g] == mjGEOM_PLANE) roles[g].part = GeomPart::kFloor;
  }
  return roles;
}

HandLoad LoadOnBody(const std::vector<ContactPoint>& contacts, const std::vector<GeomRole>& roles,
                    int body) {
  HandLoad load;
  for (const ContactPoint& c : contacts) {
    const bool second = c.body2 == body;
    if (!second && c.body1 != body) continue;
    const GeomRole& role = roles[second ? c.geom1 : c.geom2];
    const Eigen::Vector3d f_W = second ? c.f_W : Eigen::Vector3d(-c.f_W);
    if (role.part == GeomPart::kFinger) {
      load.normal[role.finger] += c.normal_force;
      if (role.phalanx == 0) load.proximal_normal[role.finger] += c.normal_force;
      load.f_W[role.finger] += f_W;
    } else if (role.part == GeomPart::kPalm) {
      load.palm_normal += c.normal_force;
      load.palm_f_W += f_W;
    }
    if (role.hand()) load.total_normal += c.normal_force;
  }
  return load;
}

}  // namespace springgrasp
