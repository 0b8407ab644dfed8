#include "demonstration/demonstration.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "base/error.h"
#include "base/files.h"
#include "demonstration/demonstration_columns.h"

namespace springgrasp {
namespace {

constexpr double kFarthest = 50;  // m; larger coordinates are surely millimetres

struct Columns {
  int t = -1;
  std::array<int, kPointColumns> points;  // column of each coordinate, -1: absent
  PerFinger<int> confidence;
  std::vector<int> further;
  std::size_t count = 0;
};

std::string_view Trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> Split(std::string_view line, char separator) {
  std::vector<std::string_view> cells;
  while (true) {
    const auto end = line.find(separator);
    cells.push_back(Trim(line.substr(0, end)));
    if (end == std::string_view::npos) return cells;
    line.remove_prefix(end + 1);
  }
}

// A number in any locale; std::nullopt if the text is anything else. May be infinite or NaN.
std::optional<double> ParseNumber(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size()) return std::nullopt;
  if (status == std::errc::result_out_of_range) return HUGE_VAL;
  if (status != std::errc()) return std::nullopt;
  return value;
}

std::vector<double> ParseNumbers(std::string_view text, std::size_t count, const char* key,
                                 const std::string& where) {
  std::vector<double> values;
  for (const std::string_view word : Split(text, ' ')) {
    if (word.empty()) continue;
    const auto value = ParseNumber(word);
    ThrowUnless(value && std::isfinite(*value), "{}: {}: '{}' is not a finite number", where, key,
                word);
    values.push_back(*value);
  }
  ThrowUnless(values.size() == count, "{}: {}: expected {} numbers, found {}", where, key, count,
              values.size());
  return values;
}

void ParseFrame(std::string_view value, const std::string& line, const std::string& where,
                Demonstration& demonstration) {
  for (const char* name : {"world", "root", "camera_left", "recording"}) {
    if (value == name) {
      demonstration.frame = name;
      return;
    }
  }
  ThrowUnless(value.find(' ') != std::string_view::npos,
              "{}: frame: '{}', expected world, root, camera_left or recording", where, value);
  demonstration.frame = "recording";
  demonstration.comments.push_back(line);
}

DemonstratedObject ParseObject(std::string_view value, const std::string& where) {
  const auto parts = Split(value, ';');
  constexpr std::string_view kPose = "pose:";
  ThrowUnless(parts.size() == 2 && parts[1].substr(0, kPose.size()) == kPose,
              "{}: object: '{}', expected SHAPE; pose: x y z qw qx qy qz", where, value);
  DemonstratedObject object;
  try {
    object.shape = ParseShape(std::string(parts[0]));
  } catch (const Error& e) {
    Fail("{}: object: {}", where, e.what());
  }
  const std::vector<double> pose =
      ParseNumbers(parts[1].substr(kPose.size()), 7, "object pose", where);
  const double norm = Eigen::Vector4d(&pose[3]).norm();
  ThrowUnless(std::abs(norm - 1) < 0.01, "{}: object: quaternion of length {}, expected 1", where,
              norm);
  object.X_WO = PoseFromArray(pose.data());
  return object;
}

// One `#` line. `up_given` remembers whether the file says where up is.
void ParseComment(std::string_view line, const std::string& where, Demonstration& demonstration,
                  bool& up_given) {
  const std::string text(Trim(line.substr(1)));
  const auto colon = text.find(':');
  const std::string key = text.substr(0, colon);
  const std::string_view value = colon == std::string::npos
                                     ? std::string_view()
                                     : Trim(std::string_view(text).substr(colon + 1));
  if (colon != std::string::npos && key == "frame") {
    ParseFrame(value, text, where, demonstration);
  } else if (colon != std::string::npos && key == "up") {
    const std::vector<double> up = ParseNumbers(value, 3, "up", where);
    const Eigen::Vector3d direction(up[0], up[1], up[2]);
    ThrowUnless(direction.norm() > 1e-9, "{}: up: '{}' has no direction", where, value);
    // What is unit already stays as it is, so that a file written again is the same file.
    const bool unit = std::abs(direction.norm() - 1) < 1e-12;
    demonstration.up = unit ? direction : Eigen::Vector3d(direction.normalized());
    up_given = true;
  } else if (colon != std::string::npos && key == "object") {
    demonstration.object = ParseObject(value, where);
  } else if (colon != std::string::npos && key == "marker_offset") {
    demonstration.marker_offset = ParseNumbers(value, 1, "marker_offset", where)[0];
    ThrowUnless(std::abs(demonstration.marker_offset) < 0.05,
                "{}: marker_offset: {} m, expected within 0.05 m", where,
                demonstration.marker_offset);
  } else if (!text.empty()) {
    demonstration.comments.push_back(text);
  }
}

Columns ParseHeader(std::string_view line, const std::string& where, Demonstration& demonstration) {
  static const std::vector<std::string> kNames = PointColumnNames();
  Columns columns;
  columns.points.fill(-1);
  columns.confidence.fill(-1);
  const auto cells = Split(line, ',');
  columns.count = cells.size();
  for (std::size_t c = 0; c < cells.size(); ++c) {
    int* slot = cells[c] == "t" ? &columns.t : nullptr;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      if (cells[c] == kNames[i]) slot = &columns.points[i];
    }
    for (int f = 0; f < kNumFingers; ++f) {
      if (cells[c] == fmt::format("{}_confidence", kFingerNames[f])) slot = &columns.confidence[f];
    }
    if (slot == nullptr) {
      columns.further.push_back(static_cast<int>(c));
      demonstration.further_columns.emplace_back(cells[c]);
      continue;
    }
    ThrowUnless(*slot < 0, "{}: column '{}' appears twice", where, cells[c]);
    *slot = static_cast<int>(c);
  }
  ThrowUnless(columns.t >= 0, "{}: expected a header line t,wrist_x,...,pinkie_z, found '{}'",
              where, line.substr(0, 60));
  return columns;
}

class RowReader {
 public:
  RowReader(const Columns& columns, const std::vector<std::string_view>& cells,
            const std::string& where)
      : columns_(columns), cells_(cells), where_(where) {}

  // The cell's number; nothing if empty or absent. Throws Error for text and non-finite values.
  std::optional<double> Number(int column, std::string_view name) const {
    if (column < 0 || cells_[column].empty()) return std::nullopt;
    const auto value = ParseNumber(cells_[column]);
    ThrowUnless(value.has_value(), "{}: {} is '{}', expected a number or an empty cell", where_,
                name, cells_[column]);
    ThrowUnless(std::isfinite(*value), "{}: {} is '{}', expected a finite number", where_, name,
                cells_[column]);
    return value;
  }

  // `count` neighbouring coordinates from `first`: all or none of them. True if present.
  bool Group(int first, int count, std::string_view what, double* values) const {
    int seen = 0;
    for (int i = 0; i < count; ++i) {
      const auto value = Number(columns_.points[first + i], what);
      if (value) values[i] = *value;
      seen += value.has_value();
    }
    ThrowUnless(seen == 0 || seen == count, "{}: {} has {} of {} numbers, expected all or none",
                where_, what, seen, count);
    return seen == count;
  }

  std::optional<Eigen::Vector3d> Point(int first, std::string_view what) const {
    Eigen::Vector3d p;
    if (!Group(first, 3, what, p.data())) return std::nullopt;
    ThrowUnless(p.cwiseAbs().maxCoeff() < kFarthest,
                "{}: {} lies {} m away, expected metres (not millimetres)", where_, what,
                p.cwiseAbs().maxCoeff());
    return p;
  }

  std::optional<Eigen::Quaterniond> Quaternion(int first, std::string_view what) const {
    Eigen::Vector4d q;
    if (!Group(first, 4, what, q.data())) return std::nullopt;
    const double norm = q.norm();
    ThrowUnless(std::abs(norm - 1) < 0.01, "{}: {} has length {}, expected a unit quaternion",
                where_, what, norm);
    // What is unit already stays as it is, so that a file written again is the same file.
    if (std::abs(norm - 1) > 1e-12) q /= norm;
    return Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  }

 private:
  const Columns& columns_;
  const std::vector<std::string_view>& cells_;
  const std::string& where_;
};

DemonstrationSample ParseSample(const Columns& columns, std::string_view line,
                                const std::string& where) {
  const auto cells = Split(line, ',');
  ThrowUnless(cells.size() == columns.count, "{}: {} cells, expected {} as in the header", where,
              cells.size(), columns.count);
  const RowReader row(columns, cells, where);
  DemonstrationSample sample;
  const auto t = row.Number(columns.t, "t");
  ThrowUnless(t.has_value(), "{}: t is empty", where);
  sample.t = *t;
  sample.p_WH = row.Point(0, "wrist position");
  sample.R_WH = row.Quaternion(3, "wrist quaternion");
  for (int f = 0; f < kNumFingers; ++f) {
    sample.p_WF[f] = row.Point(kWristColumns + 3 * f, kFingerNames[f]);
    if (!sample.p_WF[f]) continue;
    sample.confidence[f] = 1;
    if (columns.confidence[f] < 0) continue;
    const auto confidence = ParseNumber(cells[columns.confidence[f]]);
    if (confidence && *confidence >= 0 && *confidence <= 1) sample.confidence[f] = *confidence;
  }
  for (const int c : columns.further) sample.further.emplace_back(cells[c]);
  return sample;
}

// What can only be judged over the whole file.
void CheckWhole(const Demonstration& demonstration) {
  const auto& samples = demonstration.samples;
  const std::string& name = demonstration.source;
  ThrowUnless(samples.size() >= kMinSamples, "{}: {} samples, expected at least {}", name,
              samples.size(), kMinSamples);
  const PerFinger<bool> recorded = RecordedFingers(demonstration);
  const auto fingers = std::count(recorded.begin(), recorded.end(), true);
  ThrowUnless(fingers >= 2, "{}: {} finger{} seen in {} samples or more, expected at least two",
              name, fingers, fingers == 1 ? "" : "s", kMinSamples);
  std::vector<double> steps;
  for (std::size_t i = 1; i < samples.size(); ++i) steps.push_back(samples[i].t - samples[i - 1].t);
  std::nth_element(steps.begin(), steps.begin() + steps.size() / 2, steps.end());
  const double rate = 1 / steps[steps.size() / 2];
  ThrowUnless(rate > 15 * 0.98 && rate < 1000 * 1.02,
              "{}: sampled at {:.3g} Hz, expected 15 to 1000 Hz (t in seconds)", name, rate);
}

}  // namespace

std::vector<std::string> PointColumnNames() {
  std::vector<std::string> names = {"wrist_x",  "wrist_y",  "wrist_z", "wrist_qw",
                                    "wrist_qx", "wrist_qy", "wrist_qz"};
  for (const std::string_view finger : kFingerNames) {
    for (const char* axis : {"_x", "_y", "_z"}) names.push_back(std::string(finger) + axis);
  }
  return names;
}

PerFinger<bool> RecordedFingers(const Demonstration& demonstration) {
  PerFinger<bool> recorded;
  for (int f = 0; f < kNumFingers; ++f) {
    recorded[f] =
        std::count_if(demonstration.samples.begin(), demonstration.samples.end(),
                      [f](const auto& s) { return s.p_WF[f].has_value(); }) >= kMinSamples;
  }
  return recorded;
}

Demonstration ParseDemonstration(const std::string& text, const std::string& name) {
  Demonstration demonstration;
  demonstration.source = name;
  std::optional<Columns> columns;
  bool up_given = false;
  std::string_view rest = text;
  if (rest.substr(0, 3) == "\xEF\xBB\xBF") rest.remove_prefix(3);
  for (int number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    const std::string_view line = Trim(rest.substr(0, end));
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    if (line.empty()) continue;
    const std::string where = fmt::format("{}:{}", name, number);
    if (line[0] == '#') {
      ParseComment(line, where, demonstration, up_given);
    } else if (!columns) {
      columns = ParseHeader(line, where, demonstration);
    } else {
      DemonstrationSample sample = ParseSample(*columns, line, where);
      ThrowUnless(demonstration.samples.empty() || sample.t > demonstration.samples.back().t,
                  "{}: t = {} after t = {}, expected time to increase", where, sample.t,
                  demonstration.samples.empty() ? 0 : demonstration.samples.back().t);
      demonstration.samples.push_back(std::move(sample));
    }
  }
  ThrowUnless(columns.has_value(),
              "{}: empty, expected a demonstration (comments, a header line "
              "t,wrist_x,...,pinkie_z, then samples)",
              name);
  if (demonstration.frame == "camera_left" && !up_given) demonstration.up.reset();
  CheckWhole(demonstration);
  return demonstration;
}

Demonstration ReadDemonstration(const std::string& path) {
  return ParseDemonstration(ReadFile(path), path);
}

}  // namespace springgrasp
