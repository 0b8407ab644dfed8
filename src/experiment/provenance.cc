#include "experiment/provenance.h"

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <vector>

#include "base/files.h"
#include "base/random.h"
#include "experiment/store.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

std::string CpuName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

// Revision of the source folder, read from git's own files so that no git program is needed.
std::string Revision() {
  try {
    const fs::path git = fs::path(SourceFolder()) / ".git";
    std::string head = ReadFile((git / "HEAD").string());
    head.erase(head.find_last_not_of(" \n") + 1);
    if (head.rfind("ref: ", 0) != 0) return head;
    const std::string reference = head.substr(5);
    if (fs::exists(git / reference)) {
      std::string revision = ReadFile((git / reference).string());
      return revision.substr(0, revision.find('\n'));
    }
    const std::string packed = ReadFile((git / "packed-refs").string());
    const auto at = packed.find(" " + reference + "\n");
    return at == std::string::npos || at < 40 ? "unknown" : packed.substr(at - 40, 40);
  } catch (const std::exception&) {
    return "unknown";
  }
}

}  // namespace

std::string HashOfModels() {
  std::vector<std::string> files;
  const fs::path root = fs::path(SourceFolder()) / "models";
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), root));
  }
  std::sort(files.begin(), files.end());
  std::uint64_t hash = HashText("models");
  for (const std::string& file : files) {
    hash = HashText(ReadFile((root / file).string()), HashText(file, hash));
  }
  return fmt::format("{:016x}", hash);
}

std::string DescribeProvenance() {
  return fmt::format(
      "program: springgrasp {}\nbehaviour_version: {}\nrevision: {}\nmujoco: {}\ncompiler: {}\n"
      "cpu: {}\nmodels: {}\n",
      SPRINGGRASP_VERSION, kBehaviourVersion, Revision(), mj_versionString(), __VERSION__,
      CpuName(), HashOfModels());
}

}  // namespace springgrasp
