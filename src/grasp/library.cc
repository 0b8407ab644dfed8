#include "grasp/library.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "grasp/aperture.h"
#include "grasp/generate.h"
#include "grasp/learn_segment.h"
#include "grasp/learn_track.h"

namespace springgrasp {
namespace {

constexpr double kLanded = 0.001;  // m

// Span that is judged for the segment: every finger that was seen.
double SpeedOfNoise(double noise) { return 8 * noise; }  // 1/s; as in learning

// RMS distance of the generated tips from the observed ones over the reach, m.
double Distance(const Grasp& grasp, const HandTrack& track, const ReachSegment& reach,
                const std::optional<DemonstratedObject>& object) {
  constexpr int kInstants = 21;
  GenerateOptions options;
  options.shape = object ? object->shape : grasp.shape;
  options.tip_radius = grasp.tip_radius;
  options.duration = std::max(0.2, (reach.contact - reach.begin) * track.dt);
  const FingertipMotion motion = GenerateMotion(grasp, options);
  double sum = 0;
  int count = 0;
  for (int k = 0; k < kInstants; ++k) {
    const double s = k / (kInstants - 1.0);
    const auto seen =
        static_cast<std::size_t>(std::lround(reach.begin + s * (reach.contact - reach.begin)));
    const auto made = std::min(motion.samples.size() - 1,
                               static_cast<std::size_t>(std::lround(s * motion.T / options.dt)));
    for (int i = 0; i < kNumFingers; ++i) {
      if (!track.observed[i]) continue;
      sum += (track.p_HF[seen][i] - motion.samples[made].p_HF[i]).squaredNorm();
      ++count;
    }
  }
  return std::sqrt(sum / std::max(1, count));
}

}  // namespace

std::vector<LibraryEntry> ReadLibrary(const std::string& folder) {
  namespace fs = std::filesystem;
  ThrowUnless(fs::is_directory(folder), "{}: no such folder, expected one with grasps (*.yaml)",
              folder);
  std::vector<std::string> paths;
  for (const auto& file : fs::directory_iterator(folder)) {
    if (file.path().extension() == ".yaml") paths.push_back(file.path().string());
  }
  ThrowUnless(!paths.empty(), "{}: holds no grasp (*.yaml)", folder);
  std::sort(paths.begin(), paths.end());
  std::vector<LibraryEntry> library;
  for (const std::string& path : paths) {
    LibraryEntry entry{path, ReadGrasp(path)};
    for (const LibraryEntry& other : library) {
      ThrowUnless(other.grasp.name != entry.grasp.name, "{}: its name '{}' is that of {} too", path,
                  entry.grasp.name, other.path);
    }
    library.push_back(std::move(entry));
  }
  return library;
}

std::string ShippedLibrary() { return SourceFolder() + "/models/grasps"; }

std::string DemonstrationOfEntry(const std::string& path) {
  return std::filesystem::path(path).replace_extension(".csv");
}

std::vector<std::string> CheckGrasp(const Grasp& grasp) {
  std::vector<std::string> wrong;
  const DimensionlessGains gains = GainsOf(grasp);
  if (gains.zeta < 1) {
    wrong.push_back(
        fmt::format("zeta is {:.2f}: the contact springs are not over-damped", gains.zeta));
  }
  for (int i = 0; i < kNumFingers; ++i) {
    if (grasp.involved[i] && !ContactOfRay(grasp.shape, grasp.rays[i], grasp.tip_radius)) {
      wrong.push_back(fmt::format("the contact ray of the {} misses the object", kFingerNames[i]));
    }
  }
  GenerateOptions options;
  options.shape = grasp.shape;
  options.tip_radius = grasp.tip_radius;
  try {
    const FingertipMotion motion = GenerateMotion(grasp, options);
    const double error = ContactError(motion, motion.T, 1.5 * motion.T);
    if (grasp.profile == "human" && error > kLanded) {
      wrong.push_back(fmt::format("an involved tip ends {:.1f} mm from its contact", 1e3 * error));
    }
  } catch (const Error& e) {
    wrong.push_back(e.what());
  }
  return wrong;
}

std::vector<RecognisedGrasp> RecogniseGrasp(const Demonstration& demonstration,
                                            const std::vector<LibraryEntry>& library) {
  const HandTrack track = MakeHandTrack(demonstration);
  ThrowUnless(track.orientation,
              "{}: the hand's pose was not seen, so its fingers cannot be compared in H",
              demonstration.source);
  const ReachSegment reach =
      FindReach(HandSpeed(track), ThumbFingerSpan(track, track.observed), track.dt,
                SpeedOfNoise(track.hand_noise), 0.5 * track.tip_noise);
  ThrowUnless(reach.contact - reach.begin >= 10, "{}: the movement is too short to recognise",
              demonstration.source);
  std::vector<RecognisedGrasp> out;
  for (const LibraryEntry& entry : library) {
    out.push_back({entry.grasp.name, entry.grasp.type,
                   Distance(entry.grasp, track, reach, demonstration.object)});
  }
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.rmse < b.rmse; });
  return out;
}

}  // namespace springgrasp
