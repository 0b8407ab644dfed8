#include "sim/obj_check.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "sim/object_file.h"
#include "temporary_folder.h"

namespace springgrasp {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVertices = "v 0 0 0\nv .04 0 0\nv 0 .04 0\nv 0 0 .04\n";

class CheckObjTest : public testing::Test {
 protected:
  // What is said of such a file; nothing: it is sound.
  std::string Said(const std::string& text) {
    folder_.Write("mesh.obj", text);
    try {
      CheckObj(folder_ / "mesh.obj");
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  }

  TemporaryFolder folder_;
};

TEST_F(CheckObjTest, EveryMeshThatShipsPasses) {
  int count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(SourceFolder() + "/models")) {
    if (entry.path().extension() != ".obj") continue;
    EXPECT_NO_THROW(CheckObj(entry.path()));
    ++count;
  }
  EXPECT_GT(count, 0);
}

TEST_F(CheckObjTest, FacesMayNameTextureAndNormalAndCountBackwards) {
  EXPECT_EQ(Said(std::string(kVertices) + "vt 0 0\nvn 0 0 1\nf 1/1 2/1 3/1\nf 1//1 2//1 4//1\n" +
                 "f 1/1/1 3/1/1 4/1/1\nf -1 -2 -3\r\n"),
            "");
}

TEST_F(CheckObjTest, AFaceOfMissingVerticesIsAnErrorWithItsLine) {
  EXPECT_THAT(Said(std::string(kVertices) + "f 1 2 9\n"),
              testing::HasSubstr("mesh.obj:5: the face names vertex '9', expected one of the 4"));
  EXPECT_THAT(Said(std::string(kVertices) + "f 1 2 -5\n"), testing::HasSubstr("vertex '-5'"));
  EXPECT_THAT(Said(std::string(kVertices) + "f 0 1 2\n"), testing::HasSubstr("vertex '0'"));
}

TEST_F(CheckObjTest, TooFewOrHalfVerticesAreAnError) {
  EXPECT_THAT(Said("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), testing::HasSubstr("3 vertices"));
  EXPECT_THAT(Said("v 0 0\n"), testing::HasSubstr("mesh.obj:1: expected a vertex"));
  EXPECT_THAT(Said("v 0 0 nan\n"), testing::HasSubstr("mesh.obj:1: expected a vertex"));
  EXPECT_THAT(Said(""), testing::HasSubstr("0 vertices"));
}

// What MuJoCo would crash on.
TEST_F(CheckObjTest, ObjectsAreCheckedAsMeshAndInTheirMjcf) {
  folder_.Write("mesh.obj", std::string(kVertices) + "f 1 2 90000000\n");
  folder_.Write("object.xml",
                "<mujoco><compiler angle='radian'/><asset><mesh name='m' "
                "file='mesh.obj'/></asset><worldbody><body name='b'>"
                "<freejoint/><geom type='mesh' mesh='m'/></body></worldbody></mujoco>");
  for (const char* file : {"mesh.obj", "object.xml"}) {
    try {
      ReadObjectFile(folder_ / file);
      FAIL() << file;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr("mesh.obj:5")) << file;
    }
  }
}

}  // namespace
}  // namespace springgrasp
