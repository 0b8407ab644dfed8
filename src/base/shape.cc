#include "base/shape.h"

#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/error.h"

namespace springgrasp {
namespace {

std::vector<double> ParseExtents(const std::string& text, const std::string& numbers) {
  std::vector<double> extents;
  const char* cursor = numbers.c_str();
  while (*cursor != '\0') {
    char* end = nullptr;
    const double value = std::strtod(cursor, &end);
    ThrowUnless(end != cursor && std::isfinite(value) && value > 0 && (*end == 'x' || *end == '\0'),
                "shape '{}': extents must be positive metres joined by 'x', "
                "for example cylinder:0.05x0.2",
                text);
    extents.push_back(value);
    cursor = *end == 'x' ? end + 1 : end;
  }
  return extents;
}

}  // namespace

Shape ParseShape(const std::string& text) {
  const auto colon = text.find(':');
  ThrowUnless(colon != std::string::npos,
              "shape '{}': expected sphere:D, cylinder:DxH or box:XxYxZ (metres)", text);
  const std::string kind = text.substr(0, colon);
  const std::vector<double> e = ParseExtents(text, text.substr(colon + 1));
  if (kind == "sphere" && e.size() == 1) {
    return {Shape::Kind::kSphere, Eigen::Vector3d::Constant(e[0])};
  }
  if (kind == "cylinder" && e.size() == 2) {
    return {Shape::Kind::kCylinder, Eigen::Vector3d(e[0], e[0], e[1])};
  }
  if (kind == "box" && e.size() == 3) return {Shape::Kind::kBox, Eigen::Vector3d(e[0], e[1], e[2])};
  Fail("shape '{}': expected sphere:D, cylinder:DxH or box:XxYxZ (metres)", text);
}

std::string FormatShape(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::kSphere:
      return fmt::format("sphere:{}", shape.size.x());
    case Shape::Kind::kCylinder:
      return fmt::format("cylinder:{}x{}", shape.size.x(), shape.size.z());
    case Shape::Kind::kBox:
      break;
  }
  return fmt::format("box:{}x{}x{}", shape.size.x(), shape.size.y(), shape.size.z());
}

}  // namespace springgrasp
