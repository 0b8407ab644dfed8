// The surface of an object's file (object_file.h, which loads it).
#pragma once

#include <string>

#include "base/triangle_mesh.h"

namespace springgrasp {

// Triangles of a mesh file (OBJ, STL, MSH) or of an MJCF whose parts are meshes, in the frame of
// the file. Throws Error; a primitive part is one too: it is better given as a shape.
TriangleMesh ReadObjectMesh(const std::string& path);

}  // namespace springgrasp
