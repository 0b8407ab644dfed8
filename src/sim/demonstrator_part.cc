#include "sim/demonstrator_part.h"

#include <functional>
#include <optional>

#include "base/error.h"
#include "sim/mjcf_scale.h"

namespace springgrasp {
namespace {

XmlElement* FindNamed(XmlElement* root, const char* kind, const std::string& name) {
  for (XmlElement* e = root->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    if (std::string(e->Name()) == kind && e->Attribute("name", name.c_str()) != nullptr) return e;
    if (XmlElement* found = FindNamed(e, kind, name)) return found;
  }
  return nullptr;
}

XmlElement* RequireNamed(XmlElement* root, const char* kind, const std::string& name,
                         const std::string& path) {
  XmlElement* found = FindNamed(root, kind, name);
  ThrowUnless(found != nullptr, "{}: expected a <{}> named {}", path, kind, name);
  return found;
}

double OnlyNumber(const XmlElement& element, const char* attribute, const std::string& path) {
  const std::vector<double> numbers = NumbersOf(element, attribute);
  ThrowUnless(numbers.size() == 1, "{}:{}: {} of this <{}> has {} numbers, expected 1", path,
              element.GetLineNum(), attribute, element.Name(), numbers.size());
  return numbers[0];
}

// A cap as the file has it, before anything is scaled.
struct Cap {
  XmlElement* geom = nullptr;
  XmlElement* tip = nullptr;
  double extra = 0;              // m, of its radius beyond the pad's
  std::vector<double> straight;  // m, from its middle to the end of the straight part, if any
};

bool IsCap(const XmlElement& element) {
  const char* text = element.Attribute("name");
  const std::string name = text == nullptr ? "" : text;
  return std::string(element.Name()) == "geom" && name.size() > 8 && name.rfind("mmm_", 0) == 0 &&
         name.compare(name.size() - 4, 4, "_cap") == 0;
}

void CollectCaps(XmlElement* element, const std::string& path, std::vector<Cap>& caps) {
  for (XmlElement* e = element->FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    CollectCaps(e, path, caps);
    if (!IsCap(*e)) continue;
    std::string tip = e->Attribute("name");
    tip.replace(tip.size() - 4, 4, "_tip");
    Cap cap{e, RequireNamed(element, "site", tip, path), 0, {}};
    cap.extra = OnlyNumber(*e, "size", path) - OnlyNumber(*cap.tip, "size", path);
    const std::vector<double> ends = NumbersOf(*e, "fromto");
    for (std::size_t i = 0; ends.size() == 6 && i < 3; ++i) {
      cap.straight.push_back((ends[3 + i] - ends[i]) / 2);
    }
    caps.push_back(cap);
  }
}

void PutCaps(const std::vector<Cap>& caps, const Scene& scene, const std::string& path) {
  const std::optional<double>& diameter = scene.demonstrator.cap_diameter;
  for (const Cap& cap : caps) {
    const double pad = OnlyNumber(*cap.tip, "size", path);
    ThrowUnless(!diameter || *diameter > 2 * pad,
                "{}: demonstrator.cap_diameter is {} m, expected more than {:.4f} m to cover {} of "
                "a hand of {} m",
                scene.source, *diameter, 2 * pad, cap.tip->Attribute("name"),
                scene.demonstrator.hand_length);
    SetNumbers(*cap.geom, "size", {diameter ? *diameter / 2 : pad + cap.extra});
    if (cap.straight.empty()) continue;
    const std::vector<double> p = NumbersOf(*cap.tip, "pos");
    ThrowUnless(p.size() == 3, "{}:{}: expected a pos of three numbers", path,
                cap.tip->GetLineNum());
    std::vector<double> ends(6);
    for (std::size_t i = 0; i < 3; ++i) {
      ends[i] = p[i] - cap.straight[i];
      ends[3 + i] = p[i] + cap.straight[i];
    }
    SetNumbers(*cap.geom, "fromto", ends);
  }
}

}  // namespace

std::unique_ptr<XmlDocument> ReadDemonstratorPart(const std::string& path, const Scene& scene) {
  const SceneDemonstrator& who = scene.demonstrator;
  std::unique_ptr<XmlDocument> part = ReadMjcfPart(path, "demonstrator");
  XmlElement* root = part->FirstChildElement("mujoco");
  XmlElement* world = ChildOf(root, "worldbody");
  XmlElement* hand = FindBody(world, "mmm_hand");
  ThrowUnless(hand != nullptr && hand->Parent() == world,
              "{}: expected a body named mmm_hand in the world", path);
  const double length =
      OnlyNumber(*RequireNamed(root, "numeric", "mmm_hand_length", path), "data", path);
  ThrowUnless(length > 0, "{}: mmm_hand_length is {}, expected a length in metres", path, length);
  if (who.hand_length != length || who.cap_diameter) {
    std::vector<Cap> caps;
    CollectCaps(hand, path, caps);
    ScaleMjcfPart(*part, who.hand_length / length);
    PutCaps(caps, scene, path);
  }
  const auto paint = [&](const char* material, const std::optional<Eigen::Vector3d>& colour) {
    if (!colour) return;
    SetNumbers(*RequireNamed(root, "material", material, path), "rgba",
               {colour->x(), colour->y(), colour->z(), 1});
  };
  paint("mmm_cap", who.cap_colour);
  paint("mmm_skin", who.skin_colour);
  return part;
}

}  // namespace springgrasp
