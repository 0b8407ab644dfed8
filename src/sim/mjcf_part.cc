#include "sim/mjcf_part.h"

#include <array>
#include <cstring>
#include <filesystem>
#include <functional>
#include <set>
#include <vector>

#include "base/error.h"
#include "base/files.h"
#include "sim/model_index.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

void ForEach(XmlElement* element, const std::function<void(XmlElement*)>& visit) {
  if (element == nullptr) return;
  visit(element);
  for (XmlElement* c = element->FirstChildElement(); c != nullptr;) {
    XmlElement* next = c->NextSiblingElement();
    ForEach(c, visit);
    c = next;
  }
}

std::string Attribute(const XmlElement* element, const char* name) {
  const char* value = element->Attribute(name);
  return value == nullptr ? "" : value;
}

bool Is(const XmlElement* element, const char* name) {
  return std::strcmp(element->Name(), name) == 0;
}

// Asset files are found from the folder of this file, wherever the scene lies.
void MakeFilesAbsolute(XmlElement* root, const fs::path& folder) {
  fs::path meshes = folder, textures = folder;
  for (XmlElement* c = root->FirstChildElement("compiler"); c != nullptr;
       c = c->NextSiblingElement("compiler")) {
    if (c->Attribute("meshdir") != nullptr) meshes = folder / Attribute(c, "meshdir");
    if (c->Attribute("texturedir") != nullptr) textures = folder / Attribute(c, "texturedir");
    c->DeleteAttribute("meshdir");
    c->DeleteAttribute("texturedir");
  }
  ForEach(root->FirstChildElement("asset"), [&](XmlElement* e) {
    if (e->Attribute("file") == nullptr) return;
    const fs::path file = (Is(e, "texture") ? textures : meshes) / Attribute(e, "file");
    e->SetAttribute("file", fs::absolute(file).lexically_normal().c_str());
  });
}

// Turns the top default class into a named one and gives it to all that had none.
void NameDefaults(XmlElement* root, const std::string& prefix) {
  const std::string name = prefix + "_defaults";
  ForEach(root, [&](XmlElement* e) {
    for (const char* key : {"class", "childclass"}) {
      if (Attribute(e, key) == "main") e->SetAttribute(key, name.c_str());
    }
  });
  XmlElement* defaults = ChildOf(root, "default");
  defaults->SetAttribute("class", name.c_str());
  if (XmlElement* world = root->FirstChildElement("worldbody")) {
    for (XmlElement* e = world->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const char* key = Is(e, "body") ? "childclass" : "class";
      if (e->Attribute(key) == nullptr) e->SetAttribute(key, name.c_str());
    }
  }
  for (const char* section : {"asset", "contact", "tendon", "equality", "actuator"}) {
    XmlElement* s = root->FirstChildElement(section);
    if (s == nullptr) continue;
    for (XmlElement* e = s->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
      const bool classless = Is(e, "texture") || Is(e, "hfield") || Is(e, "exclude");
      if (!classless && e->Attribute("class") == nullptr) e->SetAttribute("class", name.c_str());
    }
  }
}

// Pose of a body after its frozen joints moved as given.
Pose FrozenBodyPose(const mjModel& model, int body,
                    const std::map<std::string, double>& positions) {
  Pose X = PoseFromQuat(model.body_pos + 3 * body, model.body_quat + 4 * body);
  bool kept = false;
  for (int k = 0; k < model.body_jntnum[body]; ++k) {
    const int joint = model.body_jntadr[body] + k;
    const auto found = positions.find(NameOf(model, mjOBJ_JOINT, joint));
    if (found == positions.end()) {
      kept = true;
      continue;
    }
    ThrowUnless(!kept, "joint '{}' cannot be fixed: another joint of body '{}' stands before it",
                found->first, NameOf(model, mjOBJ_BODY, body));
    const Eigen::Vector3d axis = Vector3From(model.jnt_axis + 3 * joint);
    const double motion = found->second - model.qpos0[model.jnt_qposadr[joint]];
    if (model.jnt_type[joint] == mjJNT_SLIDE) {
      X.translate(motion * axis);
    } else {
      ThrowUnless(model.jnt_type[joint] == mjJNT_HINGE, "joint '{}' is neither hinge nor slide",
                  found->first);
      const Eigen::Vector3d anchor = Vector3From(model.jnt_pos + 3 * joint);
      X = X * Eigen::Translation3d(anchor) * Eigen::AngleAxisd(motion, axis) *
          Eigen::Translation3d(-anchor);
    }
  }
  return X;
}

void SetPose(XmlElement* body, const Pose& X) {
  for (const char* key : {"axisangle", "xyaxes", "zaxis", "euler"}) body->DeleteAttribute(key);
  const Eigen::Matrix<double, 7, 1> p = PoseToArray(X);
  body->SetAttribute("pos", fmt::format("{} {} {}", p[0], p[1], p[2]).c_str());
  body->SetAttribute("quat", fmt::format("{} {} {} {}", p[3], p[4], p[5], p[6]).c_str());
}

// Deletes the children of a section for which `refers` holds; remembers their names.
void DropChildren(XmlElement* section, const std::function<bool(XmlElement*)>& refers,
                  std::set<std::string>* dropped = nullptr) {
  if (section == nullptr) return;
  for (XmlElement* e = section->FirstChildElement(); e != nullptr;) {
    XmlElement* next = e->NextSiblingElement();
    if (refers(e)) {
      if (dropped != nullptr) dropped->insert(Attribute(e, "name"));
      section->DeleteChild(e);
    }
    e = next;
  }
}

void DropReferences(XmlElement* root, const std::map<std::string, double>& joints) {
  const auto on_joint = [&](XmlElement* e) {
    for (const char* key : {"joint", "jointinparent", "joint1", "joint2"}) {
      if (e->Attribute(key) != nullptr && joints.count(Attribute(e, key)) > 0) return true;
    }
    return false;
  };
  std::set<std::string> tendons, actuators;
  if (XmlElement* section = root->FirstChildElement("tendon")) {
    for (XmlElement* t = section->FirstChildElement(); t != nullptr; t = t->NextSiblingElement()) {
      if (Is(t, "fixed")) DropChildren(t, on_joint);
    }
    DropChildren(
        section, [](XmlElement* t) { return t->NoChildren(); }, &tendons);
  }
  const auto on_tendon = [&](XmlElement* e) {
    for (const char* key : {"tendon", "tendon1", "tendon2"}) {
      if (e->Attribute(key) != nullptr && tendons.count(Attribute(e, key)) > 0) return true;
    }
    return false;
  };
  const auto on_either = [&](XmlElement* e) { return on_joint(e) || on_tendon(e); };
  DropChildren(root->FirstChildElement("equality"), on_either);
  DropChildren(root->FirstChildElement("actuator"), on_either, &actuators);
  DropChildren(root->FirstChildElement("sensor"), [&](XmlElement* e) {
    return on_either(e) ||
           (e->Attribute("actuator") != nullptr && actuators.count(Attribute(e, "actuator")) > 0);
  });
}

// MuJoCo exempts a body from collision with its parent, except when the parent is the world.
void ExcludeLostNeighbours(XmlElement* root, const mjModel& model,
                           const std::map<std::string, double>& frozen) {
  std::vector<bool> fixed(model.nbody, false);
  fixed[0] = true;
  for (int b = 1; b < model.nbody; ++b) {
    bool moves = false;
    for (int k = 0; k < model.body_jntnum[b]; ++k) {
      moves |= frozen.count(NameOf(model, mjOBJ_JOINT, model.body_jntadr[b] + k)) == 0;
    }
    fixed[b] = fixed[model.body_parentid[b]] && !moves;
  }
  XmlElement* contact = ChildOf(root, "contact");
  for (int child = 1; child < model.nbody; ++child) {
    if (fixed[child] || model.body_geomnum[child] == 0) continue;
    const int group = model.body_weldid[child];
    const int parent_group = model.body_weldid[model.body_parentid[group]];
    if (parent_group == 0 || !fixed[parent_group]) continue;
    for (int b = 1; b < model.nbody; ++b) {
      if (model.body_weldid[b] != parent_group || model.body_geomnum[b] == 0) continue;
      XmlElement* exclude = contact->InsertNewChildElement("exclude");
      exclude->SetAttribute("body1", NameOf(model, mjOBJ_BODY, b).c_str());
      exclude->SetAttribute("body2", NameOf(model, mjOBJ_BODY, child).c_str());
    }
  }
}

}  // namespace

XmlElement* ChildOf(XmlElement* parent, const char* name) {
  XmlElement* child = parent->FirstChildElement(name);
  return child != nullptr ? child : parent->InsertNewChildElement(name);
}

XmlElement* FindBody(XmlElement* root, const std::string& name) {
  XmlElement* found = nullptr;
  ForEach(root, [&](XmlElement* e) {
    if (found == nullptr && Is(e, "body") && Attribute(e, "name") == name) found = e;
  });
  return found;
}

std::unique_ptr<XmlDocument> ReadMjcfPart(const std::string& path, const std::string& prefix) {
  const std::string text = ReadFile(path);
  auto part = std::make_unique<XmlDocument>();
  part->Parse(text.c_str(), text.size());
  ThrowUnless(!part->Error(), "{}:{}: malformed XML: {}", path, part->ErrorLineNum(),
              part->ErrorName());
  XmlElement* root = part->FirstChildElement("mujoco");
  ThrowUnless(root != nullptr, "{}: expected an MJCF file with the root element <mujoco>", path);
  bool radians = false;
  ForEach(root, [&](XmlElement* e) {
    ThrowUnless(!Is(e, "include"), "{}:{}: <include> is not supported in a part of a scene", path,
                e->GetLineNum());
    radians |= Is(e, "compiler") && Attribute(e, "angle") == "radian";
  });
  ThrowUnless(radians, "{}: expected <compiler angle=\"radian\">", path);
  MakeFilesAbsolute(root, fs::path(path).parent_path());
  NameDefaults(root, prefix);
  return part;
}

void PrefixNames(XmlDocument& part, const std::string& prefix) {
  const std::string defaults = prefix + "_defaults";  // has been prefixed by ReadMjcfPart
  ForEach(part.FirstChildElement("mujoco"), [&](XmlElement* e) {
    if (Is(e, "mujoco") || Is(e, "compiler") || Is(e, "option")) return;
    for (const char* key :
         {"name",   "class",   "childclass", "material", "mesh",   "texture",
          "hfield", "target",  "joint",      "joint1",   "joint2", "jointinparent",
          "tendon", "tendon1", "tendon2",    "actuator", "body",   "body1",
          "body2",  "geom",    "geom1",      "geom2",    "site",   "objname"}) {
      const std::string value = Attribute(e, key);
      if (!value.empty() && value != defaults) e->SetAttribute(key, (prefix + "_" + value).c_str());
    }
  });
}

void DropLooks(XmlDocument& part) {
  XmlElement* world = part.FirstChildElement("mujoco")->FirstChildElement("worldbody");
  ForEach(world, [](XmlElement* e) {
    DropChildren(e,
                 [](XmlElement* c) { return Is(c, "geom") && Attribute(c, "class") == "visual"; });
  });
}

void FreezeJoints(XmlDocument& part, const mjModel& model,
                  const std::map<std::string, double>& positions) {
  if (positions.empty()) return;
  XmlElement* root = part.FirstChildElement("mujoco");
  for (int b = 1; b < model.nbody; ++b) {
    const Pose X = FrozenBodyPose(model, b, positions);
    const std::string name = NameOf(model, mjOBJ_BODY, b);
    bool touched = false;
    for (int k = 0; k < model.body_jntnum[b]; ++k) {
      touched |= positions.count(NameOf(model, mjOBJ_JOINT, model.body_jntadr[b] + k)) > 0;
    }
    if (!touched) continue;
    XmlElement* body = FindBody(root->FirstChildElement("worldbody"), name);
    ThrowUnless(body != nullptr, "a body with joints that can be fixed needs a name");
    SetPose(body, X);
    DropChildren(body, [&](XmlElement* e) {
      return Is(e, "joint") && positions.count(Attribute(e, "name")) > 0;
    });
  }
  DropReferences(root, positions);
  ExcludeLostNeighbours(root, model, positions);
}

void MergeMjcfPart(const XmlDocument& part, XmlDocument& scene) {
  const XmlElement* from = part.FirstChildElement("mujoco");
  XmlElement* to = scene.FirstChildElement("mujoco");
  for (const XmlElement* c = from->FirstChildElement("compiler"); c != nullptr;
       c = c->NextSiblingElement("compiler")) {
    for (const auto* a = c->FirstAttribute(); a != nullptr; a = a->Next()) {
      ChildOf(to, "compiler")->SetAttribute(a->Name(), a->Value());
    }
  }
  if (const XmlElement* defaults = from->FirstChildElement("default")) {
    ChildOf(to, "default")->InsertEndChild(defaults->DeepClone(&scene));
  }
  for (const char* section :
       {"asset", "worldbody", "contact", "tendon", "equality", "actuator", "sensor"}) {
    const XmlElement* s = from->FirstChildElement(section);
    for (; s != nullptr; s = s->NextSiblingElement(section)) {
      for (const auto* e = s->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
        ChildOf(to, section)->InsertEndChild(e->DeepClone(&scene));
      }
    }
  }
}

}  // namespace springgrasp
