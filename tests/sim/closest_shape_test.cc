#include "sim/closest_shape.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "base/files.h"

namespace springgrasp {
namespace {

ClosestShape Of(const std::string& file) {
  return FindClosestShape(ReadObjectFile(SourceFolder() + "/" + file).parts);
}

TEST(FindClosestShape, TakesAPrimitiveForItself) {
  EXPECT_EQ(FormatShape(Of("models/objects/ball.xml").shape), "sphere:0.067");
  EXPECT_EQ(FormatShape(Of("models/objects/food_can.xml").shape), "cylinder:0.066x0.101");
  EXPECT_EQ(FormatShape(Of("models/objects/cracker_box.xml").shape), "box:0.06x0.16x0.23");
  EXPECT_LT(Of("models/objects/food_can.xml").error, 1e-4);
}

TEST(FindClosestShape, TakesOtherThingsForWhatTheyAreNearTo) {
  EXPECT_EQ(Of("models/objects/apple.xml").shape.kind, Shape::Kind::kSphere);
  EXPECT_EQ(Of("models/objects/egg.xml").shape.kind, Shape::Kind::kSphere);
  EXPECT_EQ(Of("models/objects/drink_can.xml").shape.kind, Shape::Kind::kCylinder);
  EXPECT_EQ(Of("models/objects/bottle.xml").shape.kind, Shape::Kind::kCylinder);
  EXPECT_EQ(FormatShape(Of("models/objects/card.xml").shape), "box:0.0856x0.054x0.001");
  const ClosestShape wedge = Of("tests/testdata/sim_wedge.obj");
  EXPECT_EQ(FormatShape(wedge.shape), "box:0.06x0.04x0.04");
  EXPECT_GT(wedge.error, 1e-3);
}

TEST(FindClosestShape, AnOriginThatIsNotInTheMiddleIsAnError) {
  ObjectPart part;
  part.size[0] = 0.02;
  part.X_OP.translation().z() = 0.02;
  try {
    FindClosestShape({part});
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("20.0 mm off its origin along z"));
  }
}

TEST(FindClosestShape, MillimetresAreAnError) {
  ObjectPart part;
  part.size[0] = 20;
  EXPECT_THROW(FindClosestShape({part}), Error);
}

}  // namespace
}  // namespace springgrasp
