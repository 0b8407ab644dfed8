// What is read from the file of a mesh.
#include "sim/object_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "base/error.h"
#include "base/files.h"

namespace springgrasp {
namespace {

TEST(ReadObjectMesh, HasTheCornersAndFacesOfItsFileInItsFrame) {
  const TriangleMesh mesh = ReadObjectMesh(SourceFolder() + "/tests/testdata/sim_wedge.obj");
  EXPECT_EQ(mesh.faces.size(), 12u);
  Eigen::Vector3d least = Eigen::Vector3d::Constant(1), most = -least;
  double volume = 0;
  for (const auto& face : mesh.faces) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = mesh.vertices[static_cast<std::size_t>(face[k])];
    least = least.cwiseMin(corners.rowwise().minCoeff());
    most = most.cwiseMax(corners.rowwise().maxCoeff());
    volume += corners.determinant() / 6;
  }
  EXPECT_LT((least - Eigen::Vector3d(-0.03, -0.02, -0.02)).norm(), 1e-6);
  EXPECT_LT((most - Eigen::Vector3d(0.03, 0.02, 0.02)).norm(), 1e-6);
  // A truncated wedge: 60 mm long below, 40 mm above, 40 mm wide and high; faces look outward.
  EXPECT_NEAR(volume, 0.05 * 0.04 * 0.04, 1e-8);
}

TEST(ReadObjectMesh, WhatIsNoMeshIsAnError) {
  EXPECT_THROW(ReadObjectMesh(SourceFolder() + "/tests/testdata/sim_egg.xml"), Error);
  EXPECT_THROW(ReadObjectMesh("/nonexistent.obj"), Error);
}

}  // namespace
}  // namespace springgrasp
