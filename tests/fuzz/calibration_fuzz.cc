// Any bytes as a calibration: refused by Error, or cameras that project and triangulate. One text
// stands for both files.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "vision/camera_model.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace springgrasp;
  const std::string text(data, data + size);
  StereoCameras cameras;
  try {
    cameras = ParseStereoCalibration({text, "i.yml"}, {text, "e.yml"}, 640, 480);
  } catch (const Error& e) {
    const std::string message = e.what();
    if (message.empty() || message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  for (int v = 0; v < 2; ++v) {
    const CameraModel& camera = cameras.view(v);
    const double turn = camera.X_WC.linear().determinant();
    if (!camera.X_WC.matrix().allFinite() || !(std::abs(turn - 1) < 1e-6)) std::abort();
    for (const double x : {camera.fx, camera.fy, camera.cx, camera.cy}) {
      if (!(x > 0) || !std::isfinite(x)) std::abort();
    }
  }
  if (!((cameras.left.X_WC.translation() - cameras.right.X_WC.translation()).norm() > 0)) {
    std::abort();
  }
  // What a wild but finite lens makes of a pixel is its own affair; it must only come to an end.
  Triangulate(cameras, {100, 100}, {90, 101});
  Triangulate(cameras, {0, 0}, {639, 479});
  return 0;
}
