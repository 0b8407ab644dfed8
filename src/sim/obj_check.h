// Wavefront OBJ files that MuJoCo may be given.
#pragma once

#include <string>

namespace springgrasp {

// MuJoCo 2.2 reads beyond its arrays where a face names a vertex that is not there, and where there
// are fewer than four. Throws Error, with the line, for a file in which either is so, or a vertex
// is no three finite numbers. Files of other formats pass.
void CheckObj(const std::string& path);

}  // namespace springgrasp
