// The two files of OpenCV's stereo_calib sample, read by a scanner of the little YAML that they
// are. cv::FileStorage allocates what `rows` and `cols` ask for before anybody can judge them, and
// yaml-cpp took 2 GB for a fuzzed file of 1 kB.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/files.h"
#include "vision/camera_model.h"

namespace springgrasp {
namespace {

constexpr std::size_t kLargestFile = 1 << 20;  // bytes; the sample writes 1 to 2 kB
constexpr int kMostCoefficients = 14;          // of OpenCV's distortion
constexpr double kLargestCoefficient = 1e4;    // of a lens that is one

std::string_view Trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

// What a message may show of a file: printable, short.
std::string Shown(std::string_view text) {
  std::string shown(text.substr(0, 40));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return shown;
}

// Value of a top-level key: the rest of its line and all indented lines that follow.
struct Entry {
  std::string_view text;
  int line = 0;
};

struct CalibrationFile {
  std::string name;
  std::map<std::string_view, Entry> entries;

  std::string At(const std::string& key) const {
    return fmt::format("{}:{}", name, entries.at(key).line);
  }
};

CalibrationFile ScanEntries(const CalibrationText& file) {
  ThrowUnless(file.text.size() <= kLargestFile,
              "{}: {} bytes, expected a calibration of at most {} bytes", file.name,
              file.text.size(), kLargestFile);
  CalibrationFile result{file.name, {}};
  const std::string_view text = file.text;
  Entry* entry = nullptr;
  std::size_t value = 0;  // where the open entry's text begins
  int number = 1;
  for (std::size_t at = 0; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const bool indented = line.empty() || line[0] == ' ' || line[0] == '\t' || line[0] == '\r';
    const auto colon = line.find(':');
    if (!indented) {
      if (entry != nullptr) entry->text = text.substr(value, at - value);
      entry = nullptr;
      if (std::string_view("%#-.").find(line[0]) == std::string_view::npos) {
        ThrowUnless(colon != std::string_view::npos,
                    "{}:{}: '{}', expected a name and a colon as OpenCV's stereo_calib writes YAML",
                    file.name, number, Shown(line));
        const auto [slot, fresh] = result.entries.insert({line.substr(0, colon), {{}, number}});
        ThrowUnless(fresh, "{}:{}: '{}' is given twice", file.name, number,
                    Shown(line.substr(0, colon)));
        entry = &slot->second;
        value = at + colon + 1;
      }
    }
    at = end + 1;
  }
  if (entry != nullptr) entry->text = text.substr(value);
  return result;
}

std::optional<double> ParseNumber(std::string_view text) {
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || status != std::errc() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

// The whole number after `key` on a line of its own; 0 if there is none.
int Dimension(std::string_view text, std::string_view key) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = Trim(text.substr(at, end - at));
    if (line.starts_with(key)) {
      const auto value = ParseNumber(Trim(line.substr(key.size())));
      return value && *value > 0 && *value < 1000 ? static_cast<int>(*value) : 0;
    }
    at = end + 1;
  }
  return 0;
}

// Numbers of matrix `name`, row by row. `rows` x `cols`, either way round where one is 1; `rows` 0:
// a row or a column of any length up to kMostCoefficients.
std::vector<double> ReadMatrix(const CalibrationFile& file, const std::string& name, int rows,
                               int cols) {
  ThrowUnless(file.entries.count(name) > 0, "{}: matrix '{}' is missing", file.name, name);
  const std::string_view text = file.entries.at(name).text;
  const std::string where = file.At(name);
  const int found_rows = Dimension(text, "rows:"), found_cols = Dimension(text, "cols:");
  const auto data = text.find("data:");
  const auto open = text.find('[', data), close = text.find(']', open);
  ThrowUnless(found_rows > 0 && found_cols > 0 && data != std::string_view::npos &&
                  close != std::string_view::npos,
              "{}: '{}' is no matrix with rows, cols and data: [ ... ]", where, name);
  const bool fits =
      rows == 0 ? std::min(found_rows, found_cols) == 1 &&
                      std::max(found_rows, found_cols) <= kMostCoefficients
                : (found_rows == rows && found_cols == cols) ||
                      (std::min(rows, cols) == 1 && found_rows == cols && found_cols == rows);
  ThrowUnless(
      fits, "{}: matrix '{}' is {}x{}, expected {}", where, name, found_rows, found_cols,
      rows == 0 ? fmt::format("1x4 to 1x{}", kMostCoefficients) : fmt::format("{}x{}", rows, cols));
  std::vector<double> numbers;
  std::string_view rest = text.substr(open + 1, close - open - 1);
  while (!Trim(rest).empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view word = Trim(rest.substr(0, comma));
    const auto number = ParseNumber(word);
    ThrowUnless(number.has_value(), "{}: matrix '{}' holds '{}', expected finite numbers", where,
                name, Shown(word));
    numbers.push_back(*number);
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  ThrowUnless(numbers.size() == static_cast<std::size_t>(found_rows * found_cols),
              "{}: matrix '{}' has {} numbers, expected {}x{} of them", where, name, numbers.size(),
              found_rows, found_cols);
  return numbers;
}

// stereo_calib does not write the size of its pictures, other programs do.
void CheckPictureSize(const CalibrationFile& file, int width, int height) {
  for (const auto& [key, expected] : {std::pair("image_width", width), {"image_height", height}}) {
    if (file.entries.count(key) == 0) continue;
    const auto found = ParseNumber(Trim(file.entries.at(key).text));
    ThrowUnless(found == expected, "{}: {} is {}, but the pictures are {}x{}", file.At(key), key,
                Shown(Trim(file.entries.at(key).text)), width, height);
  }
}

CameraModel ReadCamera(const CalibrationFile& calibration, const char* M, const char* D, int width,
                       int height) {
  const std::string& file = calibration.name;
  const std::vector<double> m = ReadMatrix(calibration, M, 3, 3);
  ThrowUnless(m[0] != 0 && m[4] != 0 && m[8] != 0,
              "{}: camera matrix '{}' is singular (diagonal {}, {}, {})", file, M, m[0], m[4],
              m[8]);
  ThrowUnless(m[1] == 0 && m[3] == 0 && m[6] == 0 && m[7] == 0 && m[8] == 1,
              "{}: camera matrix '{}' is not of the form fx 0 cx; 0 fy cy; 0 0 1", file, M);
  // From a fish-eye to a telescope.
  for (const double f : {m[0], m[4]}) {
    ThrowUnless(f > 0.1 * width && f < 100 * width,
                "{}: camera matrix '{}' has a focal length of {}, expected {} to {} pixels", file,
                M, f, 0.1 * width, 100 * width);
  }
  ThrowUnless(
      m[2] > 0.3 * width && m[2] < 0.7 * width && m[5] > 0.3 * height && m[5] < 0.7 * height,
      "{}: camera matrix '{}' has its centre at ({}, {}), not near the middle of {}x{} "
      "pictures: a calibration for another size",
      file, M, m[2], m[5], width, height);
  CameraModel camera;
  camera.width = width;
  camera.height = height;
  camera.fx = m[0];
  camera.fy = m[4];
  camera.cx = m[2];
  camera.cy = m[5];
  const std::vector<double> d = ReadMatrix(calibration, D, 0, 0);
  for (std::size_t i = 0; i < d.size(); ++i) {
    ThrowUnless(std::abs(d[i]) < kLargestCoefficient,
                "{}: distortion '{}' has a coefficient of {}, expected less than {}", file, D, d[i],
                kLargestCoefficient);
    ThrowUnless(i < camera.distortion.size() || d[i] == 0,
                "{}: distortion '{}' uses coefficient {}, expected at most 8 (k1 k2 p1 p2 k3 k4 "
                "k5 k6)",
                file, D, i + 1);
    if (i < camera.distortion.size()) camera.distortion[i] = d[i];
  }
  return camera;
}

// Pose of the left camera in the right one's frame.
Pose ReadExtrinsics(const CalibrationFile& calibration) {
  const std::string& file = calibration.name;
  const std::vector<double> r = ReadMatrix(calibration, "R", 3, 3);
  const std::vector<double> t = ReadMatrix(calibration, "T", 3, 1);
  const Eigen::Matrix3d R =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(r.data());
  const Eigen::Vector3d T(t[0], t[1], t[2]);
  const double skew = (R * R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  ThrowUnless(skew < 1e-3 && R.determinant() > 0,
              "{}: matrix 'R' is not a rotation (determinant {:.3g}, R R' differs from 1 by "
              "{:.3g})",
              file, R.determinant(), skew);
  const double baseline = T.norm();
  ThrowUnless(baseline > 1e-3 && baseline < 5,
              "{}: 'T' is {:.3g} long, expected a baseline of 0.001 to 5 metres", file, baseline);
  Pose X_RL = Pose::Identity();
  X_RL.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  X_RL.translation() = T;
  return X_RL;
}

}  // namespace

StereoCameras ParseStereoCalibration(const CalibrationText& intrinsics,
                                     const CalibrationText& extrinsics, int width, int height,
                                     const Pose& X_WL) {
  StereoCameras cameras;
  const CalibrationFile in = ScanEntries(intrinsics), ex = ScanEntries(extrinsics);
  CheckPictureSize(in, width, height);
  cameras.left = ReadCamera(in, "M1", "D1", width, height);
  cameras.right = ReadCamera(in, "M2", "D2", width, height);
  cameras.left.X_WC = X_WL;
  cameras.right.X_WC = X_WL * ReadExtrinsics(ex).inverse();
  return cameras;
}

StereoCameras ReadStereoCalibration(const std::string& intrinsics, const std::string& extrinsics,
                                    int width, int height, const Pose& X_WL) {
  return ParseStereoCalibration({ReadFile(intrinsics), intrinsics},
                                {ReadFile(extrinsics), extrinsics}, width, height, X_WL);
}

}  // namespace springgrasp
