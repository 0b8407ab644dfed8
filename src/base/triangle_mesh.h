// A surface of triangles: what a mesh file tells of an object.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace springgrasp {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;  // p_OV, m
  std::vector<std::array<int, 3>> faces;  // counter-clockwise seen from outside
};

}  // namespace springgrasp
