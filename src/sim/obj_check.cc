#include "sim/obj_check.h"

#include <cmath>
#include <filesystem>
#include <sstream>

#include "base/error.h"
#include "base/files.h"

namespace springgrasp {
namespace {

// Whether a corner of a face, as `3`, `3/1`, `3//2` or `-1/4/2`, is one of `count` vertices.
bool IsVertex(const std::string& corner, long count) {
  char* end = nullptr;
  const long index = std::strtol(corner.c_str(), &end, 10);
  if (end == corner.c_str() || (*end != '\0' && *end != '/')) return false;
  return index > 0 ? index <= count : index < 0 && -index <= count;
}

bool AreNumbers(std::istringstream& words, int count) {
  for (int i = 0; i < count; ++i) {
    std::string word;
    if (!(words >> word)) return false;
    char* end = nullptr;
    if (!std::isfinite(std::strtod(word.c_str(), &end)) || *end != '\0') return false;
  }
  return true;
}

}  // namespace

void CheckObj(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".obj") return;
  std::istringstream text(ReadFile(path));
  long vertices = 0;
  int line = 0;
  for (std::string row; std::getline(text, row);) {
    ++line;
    std::istringstream words(row);
    std::string what, corner;
    words >> what;
    if (what == "v") {
      ++vertices;
      ThrowUnless(AreNumbers(words, 3), "{}:{}: expected a vertex as `v x y z`, metres, found '{}'",
                  path, line, row);
    } else if (what == "f") {
      while (words >> corner) {
        ThrowUnless(IsVertex(corner, vertices),
                    "{}:{}: the face names vertex '{}', expected one of the {} before it", path,
                    line, corner, vertices);
      }
    }
  }
  ThrowUnless(vertices >= 4, "{}: {} vertices, expected at least 4 lines `v x y z`", path,
              vertices);
}

}  // namespace springgrasp
