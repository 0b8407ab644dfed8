// A mesh of a primitive is grasped as the primitive is.
#include "grasp/mesh_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "base/error.h"
#include "base/random.h"
#include "grasp/generate.h"
#include "grasp/library.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

TriangleMesh BoxMesh(const Vector3d& size) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.emplace_back((corner & 1 ? 0.5 : -0.5) * size.x(),
                               (corner & 2 ? 0.5 : -0.5) * size.y(),
                               (corner & 4 ? 0.5 : -0.5) * size.z());
  }
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

// An upright prism whose sides touch the cylinder from inside.
TriangleMesh CylinderMesh(double diameter, double height, int sides) {
  TriangleMesh mesh;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    for (const double z : {-0.5 * height, 0.5 * height}) {
      mesh.vertices.emplace_back(0.5 * diameter * std::cos(angle), 0.5 * diameter * std::sin(angle),
                                 z);
    }
  }
  mesh.vertices.emplace_back(0, 0, -0.5 * height);
  mesh.vertices.emplace_back(0, 0, 0.5 * height);
  for (int k = 0; k < sides; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % sides);
    mesh.faces.push_back({a, b, a + 1});
    mesh.faces.push_back({a + 1, b, b + 1});
    mesh.faces.push_back({2 * sides, b, a});
    mesh.faces.push_back({2 * sides + 1, a + 1, b + 1});
  }
  return mesh;
}

ContactRay RandomRay(RandomEngine& engine) {
  const double angle = Uniform(engine, 0, 2 * std::numbers::pi);
  return {Vector3d(std::cos(angle), std::sin(angle), Uniform(engine, -0.2, 0.2)).normalized(),
          Uniform(engine, -0.3, 0.3)};
}

TEST(MeshContacts, RaysMeetAMeshWhereTheyMeetThePrimitive) {
  RandomEngine engine = MakeStream(1, 0, "mesh_contacts_test");
  const TriangleMesh box = BoxMesh({0.03, 0.06, 0.12});
  const TriangleMesh cylinder = CylinderMesh(0.05, 0.18, 240);
  for (int draw = 0; draw < 200; ++draw) {
    const ContactRay ray = RandomRay(engine);
    const auto on_box = ContactOfRay(box, ray, 0.008);
    const auto wanted = ContactOfRay(ParseShape("box:0.03x0.06x0.12"), ray, 0.008);
    ASSERT_TRUE(on_box && wanted);
    EXPECT_LT((on_box->p_OC - wanted->p_OC).norm(), 1e-9);
    EXPECT_LT((on_box->n_O - wanted->n_O).norm(), 1e-9);
    const auto on_side = ContactOfRay(cylinder, ray, 0.008);
    const auto round = ContactOfRay(ParseShape("cylinder:0.05x0.18"), ray, 0.008);
    ASSERT_TRUE(on_side && round);
    EXPECT_LT((on_side->p_OC - round->p_OC).norm(), 2e-4);
    EXPECT_GT(on_side->n_O.dot(round->n_O), std::cos(std::numbers::pi / 240 + 1e-6));
  }
}

TEST(MeshContacts, MeanRadiusOfASectionIsThatOfThePrimitive) {
  RandomEngine engine = MakeStream(2, 0, "mesh_contacts_test");
  const TriangleMesh box = BoxMesh({0.03, 0.06, 0.12});
  const TriangleMesh cylinder = CylinderMesh(0.05, 0.18, 240);
  for (int draw = 0; draw < 20; ++draw) {
    const Vector3d n(Normal(engine), Normal(engine), Normal(engine));
    EXPECT_NEAR(MeanSectionRadius(box, n), MeanSectionRadius(ParseShape("box:0.03x0.06x0.12"), n),
                1e-9);
    const double round = MeanSectionRadius(ParseShape("cylinder:0.05x0.18"), n);
    EXPECT_NEAR(MeanSectionRadius(cylinder, n), round, 1e-3 * round);
  }
}

TEST(MeshContacts, AMeshIsCentredInItsBox) {
  TriangleMesh mesh = BoxMesh({0.03, 0.06, 0.12});
  for (Vector3d& v : mesh.vertices) v += Vector3d(0.2, -0.1, 0.06);
  const TriangleMesh centred = CentredMesh(mesh);
  EXPECT_LT((BoxAround(centred).size - Vector3d(0.03, 0.06, 0.12)).norm(), 1e-12);
  EXPECT_LT((centred.vertices[0] - Vector3d(-0.015, -0.03, -0.06)).norm(), 1e-12);
  EXPECT_THROW(CentredMesh({}), Error);
  EXPECT_THROW(CentredMesh(BoxMesh({0.03, 0.06, 0})), Error);
}

// By contact rays and by the object's centre with Eq. (6).
TEST(MeshContacts, AGraspMovesAsOnThePrimitive) {
  const Grasp grasp = ReadGrasp(ShippedLibrary() + "/power.yaml");
  for (const bool centre : {false, true}) {
    GenerateOptions on_shape;
    on_shape.shape = ParseShape("box:0.05x0.05x0.18");
    on_shape.object_centre = centre;
    GenerateOptions on_mesh = on_shape;
    on_mesh.mesh = std::make_shared<const TriangleMesh>(BoxMesh(on_shape.shape.size));
    const FingertipMotion a = GenerateMotion(grasp, on_shape), b = GenerateMotion(grasp, on_mesh);
    GenerateOptions wider = on_mesh;
    wider.mesh = std::make_shared<const TriangleMesh>(BoxMesh({0.06, 0.06, 0.18}));
    const FingertipMotion c = GenerateMotion(grasp, wider);
    double same = 0, other = 0;
    for (int i = 0; i < kNumFingers; ++i) {
      same = std::max(same, (a.samples.back().p_HF[i] - b.samples.back().p_HF[i]).norm());
      other = std::max(other, (a.samples.back().p_HF[i] - c.samples.back().p_HF[i]).norm());
    }
    EXPECT_LT(same, 1e-8);
    EXPECT_GT(other, 0.002);
  }
}

}  // namespace
}  // namespace springgrasp
