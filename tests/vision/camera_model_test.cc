#include "vision/camera_model.h"

#include <gmock/gmock.h>

#include <fstream>

#include "base/error.h"
#include "vision/synthetic_caps.h"

namespace springgrasp {
namespace {

CameraModel DistortedCamera() {
  CameraModel camera;
  camera.distortion = {-0.28, 0.09, 0.0008, -0.0005, -0.01, 0, 0, 0};
  camera.X_WC.translation() = Eigen::Vector3d(0.1, -0.2, 0.05);
  camera.X_WC.linear() =
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  return camera;
}

TEST(CameraModelTest, APointOnTheAxisIsSeenAtThePrincipalPoint) {
  const CameraModel camera;
  const auto pixel = Project(camera, {0, 0, 0.7});
  ASSERT_TRUE(pixel);
  EXPECT_DOUBLE_EQ(pixel->x(), camera.cx);
  EXPECT_DOUBLE_EQ(pixel->y(), camera.cy);
  // One centimetre to the right at 0.54 m is 10.01 px.
  EXPECT_NEAR(Project(camera, {0.01, 0, 0.5405})->x(), camera.cx + 10, 1e-9);
}

TEST(CameraModelTest, NothingIsSeenBehindTheCamera) {
  EXPECT_FALSE(Project(CameraModel(), {0, 0, -0.5}));
}

TEST(CameraModelTest, RaysUndoTheLens) {
  const CameraModel camera = DistortedCamera();
  for (double x = -0.25; x < 0.3; x += 0.1) {
    for (double y = -0.2; y < 0.25; y += 0.1) {
      const Eigen::Vector3d p_W = camera.X_WC * Eigen::Vector3d(x, y, 0.6);
      const auto pixel = Project(camera, p_W);
      ASSERT_TRUE(pixel);
      const Eigen::Vector3d along = (p_W - camera.X_WC.translation()).normalized();
      EXPECT_LT((PixelRay(camera, *pixel) - along).norm(), 1e-9);
    }
  }
}

TEST(CameraModelTest, DerivativeOfTheProjectionAgreesWithDifferences) {
  const CameraModel camera = DistortedCamera();
  const Eigen::Vector3d p_W = camera.X_WC * Eigen::Vector3d(0.15, -0.1, 0.6);
  Eigen::Matrix<double, 2, 3> J;
  ASSERT_TRUE(Project(camera, p_W, &J));
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = 1e-6 * Eigen::Vector3d::Unit(i);
    const Eigen::Vector2d difference =
        (*Project(camera, p_W + step) - *Project(camera, p_W - step)) / 2e-6;
    EXPECT_LT((difference - J.col(i)).norm(), 1e-5 * J.norm());
  }
}

TEST(CameraModelTest, TriangulationFindsAGridOfPointsAgain) {
  StereoCameras eyes = TestEyes();
  eyes.left.distortion = eyes.right.distortion = DistortedCamera().distortion;
  for (double x : {-0.15, 0.0, 0.2}) {
    for (double z : {0.4, 0.7, 1.0}) {
      const Eigen::Vector3d p_W(x, -0.05, z);
      const Eigen::Vector2d left = *Project(eyes.left, p_W), right = *Project(eyes.right, p_W);
      const auto point = Triangulate(eyes, left, right);
      ASSERT_TRUE(point);
      EXPECT_LT((point->p_WQ - p_W).norm(), 1e-7);
      EXPECT_LT(point->residual_px, 1e-5);
      EXPECT_LT(EpipolarDistance(eyes, left, right), 1e-5);
      // Off the epipolar line by three pixels, whatever the disparity.
      EXPECT_NEAR(EpipolarDistance(eyes, left, right + Eigen::Vector2d(0, 3)), 3, 0.7);
      EXPECT_GT(Triangulate(eyes, left, right + Eigen::Vector2d(0, 3))->residual_px, 0.7);
    }
  }
}

TEST(CameraModelTest, ParallelRaysMeetNowhere) {
  StereoCameras eyes = TestEyes();
  eyes.right.X_WC.linear().setIdentity();
  EXPECT_FALSE(Triangulate(eyes, {300, 200}, {300, 200}));
}

class CalibrationFileTest : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) {
    const std::string path = testing::TempDir() + "springgrasp_calibration_" + name;
    std::ofstream(path) << "%YAML:1.0\n---\n" << text;
    return path;
  }
  static std::string Matrix(const std::string& name, int rows, int cols, const std::string& data) {
    return name + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
           "\n   cols: " + std::to_string(cols) + "\n   dt: d\n   data: [ " + data + " ]\n";
  }
  const std::string camera_ = "500., 0., 320., 0., 505., 240., 0., 0., 1.";
  const std::string intrinsics_ = Matrix("M1", 3, 3, camera_) +
                                  Matrix("D1", 1, 5, "-0.1, 0, 0, 0, 0") +
                                  Matrix("M2", 3, 3, camera_) + Matrix("D2", 1, 5, "0, 0, 0, 0, 0");
  const std::string rotation_ = Matrix("R", 3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.");
  const std::string shift_ = Matrix("T", 3, 1, "-0.1, 0., 0.");
};

TEST_F(CalibrationFileTest, TheRightCameraStandsWhereTSays) {
  const StereoCameras eyes = ReadStereoCalibration(Write("i.yml", intrinsics_),
                                                   Write("e.yml", rotation_ + shift_), 640, 480);
  EXPECT_NEAR(eyes.right.X_WC.translation().x(), 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(eyes.left.fx, 500);
  EXPECT_DOUBLE_EQ(eyes.left.fy, 505);
  EXPECT_DOUBLE_EQ(eyes.left.distortion[0], -0.1);
  // A point to the right of both is farther left in the right picture.
  EXPECT_GT(Project(eyes.left, {0, 0, 0.5})->x(), Project(eyes.right, {0, 0, 0.5})->x());
}

TEST_F(CalibrationFileTest, AMissingMatrixIsNamed) {
  try {
    ReadStereoCalibration(Write("i.yml", intrinsics_), Write("e.yml", rotation_), 640, 480);
    FAIL() << "accepted extrinsics without T";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("'T' is missing"), std::string::npos) << error.what();
  }
}

// What the message says when the calibration is refused; "" when it is not.
std::string Refusal(const std::string& intrinsics, const std::string& extrinsics, int width = 640,
                    int height = 480) {
  try {
    ParseStereoCalibration({intrinsics, "i.yml"}, {extrinsics, "e.yml"}, width, height);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST_F(CalibrationFileTest, BadCalibrationIsRefused) {
  using testing::HasSubstr;
  const std::string good = intrinsics_, sound = rotation_ + shift_;
  const auto with = [&](const std::string& M1) {
    return Matrix("M1", 3, 3, M1) + good.substr(good.find("D1"));
  };
  EXPECT_EQ(Refusal(good, sound), "");
  EXPECT_THROW(ReadStereoCalibration("/nowhere/i.yml", "/nowhere/e.yml", 640, 480), Error);
  EXPECT_THAT(Refusal(with("0, 0, 320, 0, 505, 240, 0, 0, 1"), sound), HasSubstr("singular"));
  EXPECT_THAT(Refusal(with("500, 0, 320, 0, 505, 240, 0, 0, .Nan"), sound), HasSubstr("finite"));
  EXPECT_THAT(Refusal(with("500, 0, 320, 0, 505"), sound), HasSubstr("5 numbers"));
  EXPECT_THAT(Refusal("M1: [1, 2\n", sound), HasSubstr("no matrix"));
  EXPECT_THAT(Refusal("", sound), HasSubstr("'M1' is missing"));
  EXPECT_THAT(Refusal(good + good, sound), HasSubstr("twice"));
  EXPECT_THAT(Refusal(good, Matrix("R", 3, 3, "1, 0, 0, 0, 2, 0, 0, 0, 1") + shift_),
              HasSubstr("not a rotation"));
  EXPECT_THAT(Refusal(good, Matrix("R", 3, 3, "1, 0, 0, 0, 1, 0, 0, 0, -1") + shift_),
              HasSubstr("not a rotation"));
  EXPECT_THAT(Refusal(good, rotation_ + Matrix("T", 3, 1, "0, 0, 0")), HasSubstr("baseline"));
  // Millimetres.
  EXPECT_THAT(Refusal(good, rotation_ + Matrix("T", 3, 1, "-93, 0, 0")), HasSubstr("baseline"));
}

TEST_F(CalibrationFileTest, AnotherPictureSizeIsNoticed) {
  for (const auto& [width, height] :
       {std::pair(320, 240), {1280, 720}, {1280, 960}, {1920, 1080}}) {
    EXPECT_NE(Refusal(intrinsics_, rotation_ + shift_, width, height), "") << width;
  }
  // A size that is told counts, however near the centre is.
  const std::string told = "image_width: 700\nimage_height: 480\n" + intrinsics_;
  EXPECT_THAT(Refusal(told, rotation_ + shift_), testing::HasSubstr("image_width"));
}

// Millions of rows cost nothing: they are refused before anything is made of them.
TEST_F(CalibrationFileTest, DimensionsAreBounded) {
  const std::string rest = intrinsics_.substr(intrinsics_.find("D1"));
  EXPECT_NE(Refusal(Matrix("M1", 2000000000, 2000000000, "1") + rest, rotation_ + shift_), "");
  EXPECT_NE(Refusal(std::string(std::size_t{2} << 20, ' '), rotation_ + shift_), "");
}

}  // namespace
}  // namespace springgrasp
