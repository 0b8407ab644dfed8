// Strict YAML reading: every key is asked for by name; what nobody asked for is an error that
// names file, line and the keys that would have been valid.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"

namespace YAML {
class Node;
}

namespace springgrasp {

struct Bounds {
  double lower = -1e300;
  double upper = 1e300;
};

// A view of one YAML map. Reading a key marks it as known; call Finish() after the last read.
//   YamlReader yaml = YamlReader::FromFile("scene.yaml");
//   yaml.Read("mass", mass, {0, 100});   // keeps the default in `mass` if the key is absent
//   yaml.Finish();                       // unknown keys throw
class YamlReader {
 public:
  // Throws Error if the file is missing, empty, or malformed (with line), or is not a map.
  static YamlReader FromFile(const std::string& path);
  static YamlReader FromText(const std::string& text, const std::string& name);

  YamlReader(YamlReader&&) noexcept;
  YamlReader& operator=(YamlReader&&) noexcept;
  ~YamlReader();

  bool Has(const std::string& key);
  // Each overload leaves the value alone when the key is absent; throws Error on a wrong type or
  // a number outside the bounds or not finite.
  void Read(const std::string& key, double& value, Bounds bounds = {});
  void Read(const std::string& key, int& value, Bounds bounds = {});
  void Read(const std::string& key, bool& value);
  void Read(const std::string& key, std::string& value);
  void Read(const std::string& key, std::string& value, const std::vector<std::string>& allowed);
  void Read(const std::string& key, Eigen::Vector3d& value, Bounds bounds = {});
  void Read(const std::string& key, std::vector<double>& value, Bounds bounds = {});
  void Read(const std::string& key, std::vector<std::string>& value);
  void Read(const std::string& key, Pose& value);  // x y z qw qx qy qz, or x y z
  // Throws Error if `key` is absent.
  void Require(const std::string& key);
  // The map under `key` (an empty one when absent); list of maps under `key`.
  YamlReader Child(const std::string& key);
  std::vector<YamlReader> Children(const std::string& key);
  // The keys of this map in file order; all are marked as known.
  std::vector<std::string> Keys();
  // The text of `key`'s value, whatever its type, as compact YAML.
  std::string Text(const std::string& key);

  // Throws Error for the first key that was never asked for.
  void Finish();
  // "file.yaml:12", for messages of semantic checks.
  std::string Where(const std::string& key) const;

 private:
  struct Impl;
  explicit YamlReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Replaces one value in a YAML text by a `key=value` override with dotted path and list indices
// (`scene.objects.0.mass=0.2`). Throws Error if the text is not of that form.
std::string ApplyOverride(const std::string& yaml_text, const std::string& key_equals_value);

// The text without the value at a dotted path, as NormaliseYaml gives it; absent keys are fine.
std::string RemoveKey(const std::string& yaml_text, const std::string& path);

// The same values as block YAML without comments or spare blanks; keys keep their order.
std::string NormaliseYaml(const std::string& yaml_text);

}  // namespace springgrasp
