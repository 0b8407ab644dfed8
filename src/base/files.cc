#include "base/files.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.h"

namespace springgrasp {

namespace fs = std::filesystem;

std::string ReadFile(const std::string& path) {
  std::error_code error;
  ThrowUnless(fs::exists(path, error), "{}: no such file", path);
  ThrowUnless(fs::is_regular_file(path, error), "{}: not a file", path);
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  ThrowUnless(in.good() || in.eof(), "{}: cannot be read", path);
  return content.str();
}

void WriteThroughTemporary(const std::string& path,
                           const std::function<void(const std::string& temporary)>& write) {
  const fs::path target(path);
  const fs::path temporary =
      target.parent_path() /
      fmt::format(".{}.{}.tmp{}", target.stem().string(), getpid(), target.extension().string());
  std::error_code ignored;
  try {
    write(temporary.string());
    fs::rename(temporary, target);
  } catch (const fs::filesystem_error& e) {
    fs::remove(temporary, ignored);
    throw NotWritten(fmt::format("{}: cannot be written ({})", path, e.code().message()));
  } catch (...) {
    fs::remove(temporary, ignored);
    throw;
  }
}

void WriteFileAtomically(const std::string& path, std::string_view content) {
  WriteThroughTemporary(path, [&](const std::string& temporary) {
    std::ofstream out(temporary, std::ios::binary);
    out.write(content.data(), static_cast<std::streamsize>(content.size()));
    out.close();
    if (!out.good()) throw NotWritten(fmt::format("{}: cannot be written", path));
  });
}

ScratchFolder::ScratchFolder(const std::string& parent)
    : path_((fs::path(parent) / ".scratch_XXXXXX").string()) {
  ThrowUnless(mkdtemp(path_.data()) != nullptr, "{}: no folder can be made there ({})", parent,
              std::strerror(errno));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string SourceFolder() {
  const char* override_folder = std::getenv("SPRINGGRASP_SOURCE_DIR");
  return override_folder != nullptr ? override_folder : SPRINGGRASP_SOURCE_DIR;
}

}  // namespace springgrasp
