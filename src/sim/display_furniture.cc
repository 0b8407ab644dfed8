#include "sim/display_furniture.h"

#include <fmt/format.h>

#include "base/fingers.h"

namespace springgrasp {
namespace {

constexpr const char* kParked = "0 0 -5";

XmlElement* AddBody(const std::string& name, XmlElement* root) {
  XmlElement* body = ChildOf(root, "worldbody")->InsertNewChildElement("body");
  body->SetAttribute("name", name.c_str());
  body->SetAttribute("mocap", true);
  body->SetAttribute("pos", kParked);
  return body;
}

// A geom that collides with nothing; `look`: four numbers from 0 to 1, or a material's name.
void AddGeom(XmlElement* body, const char* type, const char* size, const char* pos,
             const char* look) {
  XmlElement* geom = body->InsertNewChildElement("geom");
  geom->SetAttribute("type", type);
  geom->SetAttribute("size", size);
  geom->SetAttribute("pos", pos);
  const bool material = look[0] != '.' && look[0] != '0' && look[0] != '1';
  geom->SetAttribute(material ? "material" : "rgba", look);
  geom->SetAttribute("contype", 0);
  geom->SetAttribute("conaffinity", 0);
}

void AddMaterial(XmlElement* root, const char* name, const char* builtin, const char* mark,
                 const char* rgb1, const char* rgb2, const char* repeat) {
  XmlElement* asset = ChildOf(root, "asset");
  XmlElement* texture = asset->InsertNewChildElement("texture");
  texture->SetAttribute("name", name);
  texture->SetAttribute("type", "cube");
  texture->SetAttribute("builtin", builtin);
  texture->SetAttribute("mark", mark);
  texture->SetAttribute("markrgb", rgb2);
  texture->SetAttribute("random", 0.06);
  texture->SetAttribute("rgb1", rgb1);
  texture->SetAttribute("rgb2", rgb2);
  texture->SetAttribute("width", 64);
  texture->SetAttribute("height", 64);
  XmlElement* material = asset->InsertNewChildElement("material");
  material->SetAttribute("name", name);
  material->SetAttribute("texture", name);
  material->SetAttribute("texrepeat", repeat);
}

// Height of the board that a thing stands on, m.
constexpr double kBottom[] = {-0.1, -0.045, -0.06, -0.05, -0.08, -0.085, -0.055, -0.06};

void AddThing(int kind, XmlElement* body) {
  AddGeom(body, "box", "0.1 0.07 0.005", fmt::format("0 0 {}", kBottom[kind] - 0.005).c_str(),
          ".8 .78 .74 1");
  switch (kind) {
    case 0:  // plant
      AddGeom(body, "cylinder", "0.05 0.04", "0 0 -0.06", ".5 .28 .18 1");
      AddGeom(body, "ellipsoid", "0.06 0.06 0.07", "0 0 0.04", ".2 .5 .15 1");
      AddGeom(body, "sphere", "0.045", "0.05 0.01 0.02", ".25 .58 .18 1");
      AddGeom(body, "sphere", "0.045", "-0.05 0.02 0.04", ".16 .45 .14 1");
      AddGeom(body, "sphere", "0.04", "0.01 -0.04 0.08", ".3 .6 .2 1");
      return;
    case 1:  // cup
      AddGeom(body, "cylinder", "0.035 0.045", "0 0 0", ".66 .8 .2 1");
      AddGeom(body, "cylinder", "0.037 0.004", "0 0 0.043", ".95 .95 .9 1");
      return;
    case 2:
      AddGeom(body, "box", "0.05 0.04 0.06", "0 0 0", ".1 .7 .75 1");
      return;
    case 3:
      AddGeom(body, "box", "0.06 0.05 0.05", "0 0 0", "clutter_cheques");
      return;
    case 4:  // wood, near the colour of skin
      AddGeom(body, "box", "0.03 0.03 0.08", "0 0 0", ".78 .6 .45 1");
      return;
    case 5:  // books
      AddGeom(body, "box", "0.018 0.06 0.085", "0 0 0", ".12 .5 .3 1");
      AddGeom(body, "box", "0.014 0.06 0.075", "0.034 0 -0.01", ".75 .2 .15 1");
      AddGeom(body, "box", "0.012 0.06 0.08", "-0.032 0 -0.005", ".85 .8 .6 1");
      return;
    case 6:
      AddGeom(body, "sphere", "0.055", "0 0 0", "clutter_spots");
      return;
    default:
      AddGeom(body, "cylinder", "0.04 0.06", "0 0 0", "clutter_stripes");
      AddGeom(body, "cylinder", "0.03 0.01", "0 0 0.07", ".8 .5 .1 1");
  }
}

constexpr int kKinds = 8;

}  // namespace

std::string OccluderName(int finger) {
  return fmt::format("occluder_{}", kFingerNames[static_cast<std::size_t>(finger)]);
}

std::string ClutterName(int thing) { return fmt::format("clutter_{}", thing); }

void AddOccluders(const Scene& scene, XmlElement* root) {
  const std::string size = fmt::format("{0} {0} 0.0015", kOccluderHalf);
  for (const int finger : scene.demonstrator.occlusion.fingers) {
    AddGeom(AddBody(OccluderName(finger), root), "box", size.c_str(), "0 0 0", ".35 .36 .4 1");
  }
}

void AddClutter(const Scene& scene, XmlElement* root) {
  if (scene.demonstrator.clutter == 0) return;
  AddMaterial(root, "clutter_cheques", "checker", "none", ".85 .2 .2", ".92 .9 .85", "3 3");
  AddMaterial(root, "clutter_spots", "flat", "random", ".2 .3 .75", ".95 .9 .3", "2 2");
  AddMaterial(root, "clutter_stripes", "checker", "none", ".15 .4 .25", ".9 .9 .8", "1 6");
  for (int i = 0; i < scene.demonstrator.clutter; ++i) {
    AddThing(i % kKinds, AddBody(ClutterName(i), root));
  }
}

}  // namespace springgrasp
