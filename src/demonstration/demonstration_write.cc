#include <iterator>

#include "base/error.h"
#include "base/files.h"
#include "demonstration/demonstration.h"
#include "demonstration/demonstration_columns.h"

namespace springgrasp {

std::string FormatDemonstration(const Demonstration& demonstration) {
  fmt::memory_buffer out;
  const auto write = [&out]<typename... Args>(fmt::format_string<Args...> format, Args&&... args) {
    fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
  };
  const auto write_numbers = [&write](const double* values, int count, char separator) {
    for (int i = 0; i < count; ++i) write("{}{}", separator, values[i]);
  };
  write("# frame: {}\n", demonstration.frame);
  if (demonstration.up) {
    write("# up:");
    write_numbers(demonstration.up->data(), 3, ' ');
    write("\n");
  }
  if (demonstration.object) {
    write("# object: {}; pose:", FormatShape(demonstration.object->shape));
    write_numbers(PoseToArray(demonstration.object->X_WO).data(), 7, ' ');
    write("\n");
  }
  if (demonstration.marker_offset != 0) {
    write("# marker_offset: {}\n", demonstration.marker_offset);
  }
  for (const std::string& comment : demonstration.comments) {
    // A description of the frame was read as such; the four known names stand above.
    write("# {}\n", comment.starts_with("frame:") ? "original " + comment : comment);
  }
  write("t");
  for (const std::string& column : PointColumnNames()) write(",{}", column);
  for (const std::string_view finger : kFingerNames) write(",{}_confidence", finger);
  for (const std::string& column : demonstration.further_columns) write(",{}", column);
  write("\n");
  for (const DemonstrationSample& sample : demonstration.samples) {
    write("{}", sample.t);
    if (sample.p_WH) {
      write_numbers(sample.p_WH->data(), 3, ',');
    } else {
      write(",,,");
    }
    if (sample.R_WH) {
      const Eigen::Quaterniond& q = *sample.R_WH;
      write(",{},{},{},{}", q.w(), q.x(), q.y(), q.z());
    } else {
      write(",,,,");
    }
    for (const auto& tip : sample.p_WF) {
      if (tip) {
        write_numbers(tip->data(), 3, ',');
      } else {
        write(",,,");
      }
    }
    for (int f = 0; f < kNumFingers; ++f) {
      if (sample.p_WF[f]) {
        write(",{}", sample.confidence[f]);
      } else {
        write(",");
      }
    }
    for (std::size_t i = 0; i < demonstration.further_columns.size(); ++i) {
      write(",{}", i < sample.further.size() ? sample.further[i] : std::string());
    }
    write("\n");
  }
  return fmt::to_string(out);
}

void WriteDemonstration(const Demonstration& demonstration, const std::string& path) {
  WriteFileAtomically(path, FormatDemonstration(demonstration));
}

}  // namespace springgrasp
