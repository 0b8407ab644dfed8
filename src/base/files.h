// Files that a reader never sees half written.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace springgrasp {

// Whole content of a file. Throws Error naming the path if it cannot be read.
std::string ReadFile(const std::string& path);

// Writes to a temporary name beside `path`, then renames. Throws Error; leaves nothing behind.
void WriteFileAtomically(const std::string& path, std::string_view content);

// Calls `write` with a temporary name beside `path` (same extension), then renames the result.
// The temporary file is removed if `write` throws.
void WriteThroughTemporary(const std::string& path,
                           const std::function<void(const std::string& temporary)>& write);

// A new folder below `parent` with a name of its own; removed with all it holds at the end.
class ScratchFolder {
 public:
  // Throws Error if it cannot be made.
  explicit ScratchFolder(const std::string& parent);
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Folder of the files shipped with the program (models, scenes, experiments).
std::string SourceFolder();

}  // namespace springgrasp
