#include "base/yaml_reader.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/files.h"

namespace springgrasp {

struct YamlReader::Impl {
  YAML::Node node;
  std::string file;
  std::string path;  // dotted path of this map, for messages
  std::vector<std::string> known;
  std::set<std::string> asked;

  std::string At(const YAML::Node& n) const {
    return fmt::format("{}:{}", file, n.Mark().line + 1);
  }
  std::string Name(const std::string& key) const { return path.empty() ? key : path + "." + key; }
  YAML::Node Find(const std::string& key) {
    if (asked.insert(key).second) known.push_back(key);
    if (!node || !node.IsMap()) return YAML::Node(YAML::NodeType::Undefined);
    const YAML::Node& constant = node;
    return constant[key];
  }
};

namespace {

YAML::Node Load(const std::string& text, const std::string& name) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    ThrowUnless(!documents.empty() && !documents[0].IsNull(), "{}: the file is empty", name);
    ThrowUnless(documents.size() == 1, "{}: found {} YAML documents, expected one", name,
                documents.size());
    ThrowUnless(documents[0].IsMap(), "{}:1: expected a map of keys and values", name);
    return documents[0];
  } catch (const YAML::Exception& e) {
    Fail("{}:{}: malformed YAML: {}", name, e.mark.line + 1, e.msg);
  }
}

template <typename T>
bool Convert(const YAML::Node& node, T& value) {
  if (!node.IsScalar()) return false;
  return YAML::convert<T>::decode(node, value);
}

std::string Shown(const YAML::Node& node) {
  YAML::Emitter out;
  out.SetSeqFormat(YAML::Flow);
  out.SetMapFormat(YAML::Flow);
  out << node;
  std::string text = out.c_str();
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string Emitted(const YAML::Node& node) {
  YAML::Emitter out;
  out << node;
  return std::string(out.c_str()) + "\n";
}

void CheckNumber(double value, Bounds bounds, const std::string& where, const std::string& name) {
  ThrowUnless(std::isfinite(value), "{}: {} is {}, expected a finite number", where, name, value);
  ThrowUnless(value >= bounds.lower && value <= bounds.upper,
              "{}: {} is {}, expected a number from {} to {}", where, name, value, bounds.lower,
              bounds.upper);
}

std::vector<double> Numbers(const YAML::Node& node, Bounds bounds, const std::string& where,
                            const std::string& name) {
  ThrowUnless(node.IsSequence(), "{}: {} is '{}', expected a list of numbers", where, name,
              Shown(node));
  std::vector<double> values;
  for (const YAML::Node& item : node) {
    double value = 0;
    ThrowUnless(Convert(item, value), "{}: {} holds '{}', expected a number", where, name,
                Shown(item));
    CheckNumber(value, bounds, where, name);
    values.push_back(value);
  }
  return values;
}

std::string Join(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

YamlReader::YamlReader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
YamlReader::YamlReader(YamlReader&&) noexcept = default;
YamlReader& YamlReader::operator=(YamlReader&&) noexcept = default;
YamlReader::~YamlReader() = default;

YamlReader YamlReader::FromFile(const std::string& path) { return FromText(ReadFile(path), path); }

YamlReader YamlReader::FromText(const std::string& text, const std::string& name) {
  auto impl = std::make_unique<Impl>();
  impl->node = Load(text, name);
  impl->file = name;
  return YamlReader(std::move(impl));
}

bool YamlReader::Has(const std::string& key) { return impl_->Find(key).IsDefined(); }

void YamlReader::Require(const std::string& key) {
  ThrowUnless(Has(key), "{}:{}: key '{}' is missing", impl_->file,
              impl_->node.IsDefined() ? impl_->node.Mark().line + 1 : 1, impl_->Name(key));
}

void YamlReader::Read(const std::string& key, double& value, Bounds bounds) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  double read = 0;
  ThrowUnless(Convert(n, read), "{}: {} is '{}', expected a number", impl_->At(n), impl_->Name(key),
              Shown(n));
  CheckNumber(read, bounds, impl_->At(n), impl_->Name(key));
  value = read;
}

void YamlReader::Read(const std::string& key, int& value, Bounds bounds) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  int read = 0;
  ThrowUnless(Convert(n, read), "{}: {} is '{}', expected a whole number", impl_->At(n),
              impl_->Name(key), Shown(n));
  CheckNumber(read, bounds, impl_->At(n), impl_->Name(key));
  value = read;
}

void YamlReader::Read(const std::string& key, bool& value) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  ThrowUnless(Convert(n, value), "{}: {} is '{}', expected true or false", impl_->At(n),
              impl_->Name(key), Shown(n));
}

void YamlReader::Read(const std::string& key, std::string& value) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  ThrowUnless(n.IsScalar(), "{}: {} is '{}', expected a text", impl_->At(n), impl_->Name(key),
              Shown(n));
  value = n.Scalar();
}

void YamlReader::Read(const std::string& key, std::string& value,
                      const std::vector<std::string>& allowed) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  std::string read;
  Read(key, read);
  ThrowUnless(std::find(allowed.begin(), allowed.end(), read) != allowed.end(),
              "{}: {} is '{}', expected one of {}", impl_->At(n), impl_->Name(key), read,
              Join(allowed));
  value = read;
}

void YamlReader::Read(const std::string& key, Eigen::Vector3d& value, Bounds bounds) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  const std::vector<double> v = Numbers(n, bounds, impl_->At(n), impl_->Name(key));
  ThrowUnless(v.size() == 3, "{}: {} has {} numbers, expected 3", impl_->At(n), impl_->Name(key),
              v.size());
  value = Eigen::Vector3d(v[0], v[1], v[2]);
}

void YamlReader::Read(const std::string& key, std::vector<double>& value, Bounds bounds) {
  const YAML::Node n = impl_->Find(key);
  if (n.IsDefined()) value = Numbers(n, bounds, impl_->At(n), impl_->Name(key));
}

void YamlReader::Read(const std::string& key, std::vector<std::string>& value) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  ThrowUnless(n.IsSequence(), "{}: {} is '{}', expected a list", impl_->At(n), impl_->Name(key),
              Shown(n));
  value.clear();
  for (const YAML::Node& item : n) {
    ThrowUnless(item.IsScalar(), "{}: {} holds '{}', expected texts", impl_->At(n),
                impl_->Name(key), Shown(item));
    value.push_back(item.Scalar());
  }
}

void YamlReader::Read(const std::string& key, Pose& value) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return;
  std::vector<double> v = Numbers(n, {}, impl_->At(n), impl_->Name(key));
  ThrowUnless(v.size() == 3 || v.size() == 7,
              "{}: {} has {} numbers, expected 3 (x y z) or 7 "
              "(x y z qw qx qy qz)",
              impl_->At(n), impl_->Name(key), v.size());
  if (v.size() == 3) v.insert(v.end(), {1, 0, 0, 0});
  const double norm = Eigen::Map<Eigen::Vector4d>(&v[3]).norm();
  ThrowUnless(std::abs(norm - 1) < 1e-2, "{}: {} has a quaternion of norm {}, expected 1",
              impl_->At(n), impl_->Name(key), norm);
  value = PoseFromArray(v.data());
}

YamlReader YamlReader::Child(const std::string& key) {
  auto impl = std::make_unique<Impl>();
  const YAML::Node n = impl_->Find(key);
  if (n.IsDefined()) {
    ThrowUnless(n.IsMap(), "{}: {} is '{}', expected a map of keys and values", impl_->At(n),
                impl_->Name(key), Shown(n));
    impl->node.reset(n);
  } else {
    impl->node.reset(YAML::Node(YAML::NodeType::Map));
  }
  impl->file = impl_->file;
  impl->path = impl_->Name(key);
  return YamlReader(std::move(impl));
}

std::vector<YamlReader> YamlReader::Children(const std::string& key) {
  std::vector<YamlReader> children;
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return children;
  ThrowUnless(n.IsSequence(), "{}: {} is '{}', expected a list", impl_->At(n), impl_->Name(key),
              Shown(n));
  for (std::size_t i = 0; i < n.size(); ++i) {
    const YAML::Node item = n[i];
    ThrowUnless(item.IsMap(), "{}: {}[{}] is '{}', expected a map of keys and values",
                impl_->At(item), impl_->Name(key), i, Shown(item));
    auto impl = std::make_unique<Impl>();
    impl->node.reset(item);
    impl->file = impl_->file;
    impl->path = fmt::format("{}[{}]", impl_->Name(key), i);
    children.push_back(YamlReader(std::move(impl)));
  }
  return children;
}

std::vector<std::string> YamlReader::Keys() {
  std::vector<std::string> keys;
  for (const auto& item : impl_->node) {
    keys.push_back(item.first.Scalar());
    impl_->Find(keys.back());
  }
  return keys;
}

std::string YamlReader::Text(const std::string& key) {
  const YAML::Node n = impl_->Find(key);
  if (!n.IsDefined()) return "";
  YAML::Emitter out;
  out.SetSeqFormat(YAML::Flow);
  out.SetMapFormat(YAML::Flow);
  out << n;
  return out.c_str();
}

void YamlReader::Finish() {
  std::set<std::string> seen;
  for (const auto& item : impl_->node) {
    const std::string key = item.first.Scalar();
    ThrowUnless(seen.insert(key).second, "{}: key '{}' is given twice", impl_->At(item.first),
                impl_->Name(key));
    ThrowUnless(impl_->asked.count(key) > 0, "{}: unknown key '{}', expected one of {}",
                impl_->At(item.first), impl_->Name(key), Join(impl_->known));
  }
}

std::string YamlReader::Where(const std::string& key) const {
  const YAML::Node& constant = impl_->node;
  const YAML::Node n = constant.IsMap() ? constant[key] : YAML::Node();
  return impl_->At(n.IsDefined() && n.Mark().line >= 0 ? n : constant);
}

std::string ApplyOverride(const std::string& yaml_text, const std::string& key_equals_value) {
  const auto equals = key_equals_value.find('=');
  ThrowUnless(equals != std::string::npos && equals > 0,
              "--set '{}': expected key=value, for example seed=7", key_equals_value);
  YAML::Node root = Load(yaml_text, "(configuration)");
  YAML::Node value;
  try {
    value = YAML::Load(key_equals_value.substr(equals + 1));
  } catch (const YAML::Exception& e) {
    Fail("--set '{}': the value is malformed YAML: {}", key_equals_value, e.msg);
  }
  YAML::Node node;
  node.reset(root);
  std::string rest = key_equals_value.substr(0, equals);
  for (;;) {
    const auto dot = rest.find('.');
    const std::string key = rest.substr(0, dot);
    const bool last = dot == std::string::npos;
    YAML::Node next;
    if (node.IsSequence()) {
      char* end = nullptr;
      const unsigned long index = std::strtoul(key.c_str(), &end, 10);
      ThrowUnless(!key.empty() && *end == '\0' && index < node.size(),
                  "--set '{}': '{}' is not an index into a list of {}", key_equals_value, key,
                  node.size());
      if (last)
        node[index] = value;
      else
        next.reset(node[index]);
    } else {
      ThrowUnless(!node.IsScalar(), "--set '{}': '{}' is inside a plain value", key_equals_value,
                  key);
      if (last)
        node[key] = value;
      else
        next.reset(node[key]);
    }
    if (last) break;
    node.reset(next);
    rest = rest.substr(dot + 1);
  }
  return Emitted(root);
}

std::string RemoveKey(const std::string& yaml_text, const std::string& path) {
  YAML::Node root = Load(yaml_text, "(configuration)");
  YAML::Node node;
  node.reset(root);
  std::string rest = path;
  for (auto dot = rest.find('.'); dot != std::string::npos; dot = rest.find('.')) {
    const std::string key = rest.substr(0, dot);
    const YAML::Node next =
        node.IsSequence() ? node[std::strtoul(key.c_str(), nullptr, 10)] : node[key];
    if (!next.IsDefined() || next.IsScalar() || next.IsNull()) return Emitted(root);
    node.reset(next);
    rest = rest.substr(dot + 1);
  }
  if (node.IsMap()) node.remove(rest);
  return Emitted(root);
}

std::string NormaliseYaml(const std::string& yaml_text) {
  return Emitted(Load(yaml_text, "(configuration)"));
}

}  // namespace springgrasp
