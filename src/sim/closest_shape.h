// What an object of any form is taken for where a primitive is needed.
#pragma once

#include <vector>

#include "base/shape.h"
#include "sim/object_file.h"

namespace springgrasp {

struct ClosestShape {
  Shape shape;       // about O, upright along its z
  double error = 0;  // m, RMS over all directions, of how far its reach differs from the object's
};

// Of the sphere, cylinder and box of the object's own extents the one that reaches most nearly as
// far as the object in every direction; at least 1 mm thick. Throws Error unless O lies in the
// middle of the object, and where its extents are none of metres (0.5 mm to 1 m).
ClosestShape FindClosestShape(const std::vector<ObjectPart>& parts);

}  // namespace springgrasp
