#include "apps/command.h"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <sstream>
#include <vector>

#include "base/error.h"

namespace springgrasp {

namespace fs = std::filesystem;

CLI::App* AddCommand(CLI::App& app, const std::string& name, const std::string& description,
                     const std::string& example_arguments) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer("Example, from the root of the repository:\n  build/release/bin/springgrasp " +
                  name + " " + example_arguments);
  return command;
}

void CheckOutputPath(const std::string& path) {
  if (path.empty()) return;
  std::error_code ignored;
  ThrowUnless(!fs::is_directory(path, ignored), "{}: is a folder, expected a file name", path);
  fs::path folder = fs::absolute(path).parent_path();
  while (!fs::exists(folder, ignored)) folder = folder.parent_path();
  ThrowUnless(fs::is_directory(folder, ignored) && access(folder.c_str(), W_OK) == 0,
              "{}: the folder {} cannot be written to", path, folder.string());
}

void MakeFolderOf(const std::string& path) {
  if (path.empty()) return;
  const fs::path folder = fs::absolute(path).parent_path();
  std::error_code error;
  fs::create_directories(folder, error);
  ThrowUnless(fs::is_directory(folder), "{}: cannot be created ({})", folder.string(),
              error.message());
}

Pose ParsePose(const std::string& text, const std::string& option) {
  std::istringstream stream(text);
  std::vector<double> v;
  for (std::string word; stream >> word;) {
    char* end = nullptr;
    v.push_back(std::strtod(word.c_str(), &end));
    ThrowUnless(*end == '\0' && std::isfinite(v.back()), "{} holds '{}', expected numbers", option,
                word);
  }
  ThrowUnless(v.size() == 3 || v.size() == 7,
              "{} has {} numbers, expected 3 (x y z) or 7 (x y z qw qx qy qz)", option, v.size());
  if (v.size() == 3) v.insert(v.end(), {1, 0, 0, 0});
  const double norm = Eigen::Map<Eigen::Vector4d>(&v[3]).norm();
  ThrowUnless(std::abs(norm - 1) < 1e-2, "{} has a quaternion of norm {}, expected 1", option,
              norm);
  return PoseFromArray(v.data());
}

}  // namespace springgrasp
