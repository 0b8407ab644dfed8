#include "sim/mjcf_scale.h"

#include <set>
#include <sstream>
#include <string>

#include "base/error.h"

namespace springgrasp {
namespace {

void ScaleNumbers(XmlElement& element, const char* attribute, double factor) {
  if (element.Attribute(attribute) == nullptr) return;
  std::vector<double> numbers = NumbersOf(element, attribute);
  for (double& x : numbers) x *= factor;
  SetNumbers(element, attribute, numbers);
}

void CheckScalable(const XmlElement& element) {
  const std::string kind = element.Name();
  ThrowUnless(
      kind != "inertial" && kind != "mesh" && kind != "hfield",
      "line {}: a part with <{}> cannot be scaled, expected primitive shapes with densities",
      element.GetLineNum(), kind);
  const char* type = element.Attribute("type");
  ThrowUnless(kind != "joint" || type == nullptr || std::string(type) != "slide",
              "line {}: a part with slide joints cannot be scaled, expected hinges",
              element.GetLineNum());
}

void ScaleElement(XmlElement& element, double factor) {
  static const std::set<std::string> kWithLengths = {"body", "joint",  "geom",
                                                     "site", "camera", "light"};
  CheckScalable(element);
  if (kWithLengths.count(element.Name()) > 0) {
    for (const char* length : {"pos", "size", "fromto"}) ScaleNumbers(element, length, factor);
    ScaleNumbers(element, "mass", factor * factor * factor);
  }
  for (XmlElement* e = element.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    ScaleElement(*e, factor);
  }
}

}  // namespace

std::vector<double> NumbersOf(const XmlElement& element, const char* attribute) {
  std::vector<double> numbers;
  const char* text = element.Attribute(attribute);
  if (text == nullptr) return numbers;
  std::istringstream in(text);
  for (double x = 0; in >> x;) numbers.push_back(x);
  ThrowUnless(in.eof(), "line {}: {} of a <{}> is '{}', expected numbers", element.GetLineNum(),
              attribute, element.Name(), text);
  return numbers;
}

void SetNumbers(XmlElement& element, const char* attribute, const std::vector<double>& numbers) {
  element.SetAttribute(attribute, fmt::format("{}", fmt::join(numbers, " ")).c_str());
}

void ScaleMjcfPart(XmlDocument& part, double factor) {
  ThrowUnless(factor > 0, "a model cannot be scaled by {}, expected a positive factor", factor);
  if (factor == 1) return;
  XmlElement* root = part.FirstChildElement("mujoco");
  for (const char* section : {"default", "asset", "worldbody"}) {
    for (XmlElement* s = root->FirstChildElement(section); s != nullptr;
         s = s->NextSiblingElement(section)) {
      ScaleElement(*s, factor);
    }
  }
}

}  // namespace springgrasp
