// What the two halves of the grasp file share: numbers as text, and back.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iterator>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/pose.h"
#include "base/yaml_reader.h"
#include "motion/dmp.h"

namespace springgrasp {

inline std::string List(const double* values, std::size_t count) {
  std::string out = "[";
  for (std::size_t i = 0; i < count; ++i) {
    fmt::format_to(std::back_inserter(out), "{}{:.17g}", i == 0 ? "" : ", ", values[i]);
  }
  return out + "]";
}
inline std::string List(const Eigen::Vector3d& v) { return List(v.data(), 3); }
inline std::string List(const std::vector<double>& v) { return List(v.data(), v.size()); }
// A pose goes through a quaternion, whose last digit may turn: with one digit
// less, what was read is written again as it was.
inline std::string List(const Pose& X) {
  return fmt::format("[{:.15g}]", fmt::join(PoseToArray(X), ", "));
}
inline std::string Column(const Eigen::MatrixXd& m, Eigen::Index column) {
  const Eigen::VectorXd v = m.col(column);
  return List(v.data(), static_cast<std::size_t>(v.size()));
}

template <typename... Args>
void ReadRequired(YamlReader& yaml, const std::string& key, Args&&... args) {
  yaml.Require(key);
  yaml.Read(key, std::forward<Args>(args)...);
}

// Numbers of one line; `size` 0: any number of them.
inline Eigen::VectorXd ReadVector(YamlReader& yaml, const std::string& key, std::size_t size) {
  std::vector<double> values;
  ReadRequired(yaml, key, values, Bounds{-1e12, 1e12});
  ThrowUnless(size == 0 || values.size() == size, "{}: {} has {} numbers, expected {}",
              yaml.Where(key), key, values.size(), size);
  return Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
}

// The reach of a grasp (grasp_yaml_reach.cc).
void FormatReach(std::string& out, const PoseDmp& reach);
void ParseReach(YamlReader yaml, PoseDmp& reach);

}  // namespace springgrasp
