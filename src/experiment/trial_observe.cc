#include "experiment/trial_observe.h"

#include <fmt/format.h>

#include <chrono>
#include <filesystem>

#include "base/files.h"
#include "base/random.h"
#include "experiment/observe.h"

namespace springgrasp {
namespace {

constexpr double kMinSeen = 0.6;        // of the frames, else `untracked`
constexpr double kMaxUnseenEnd = 0.15;  // s before contact, else `untracked`

void RecordTracking(const Observation& seen, const std::vector<TrackingFrame>& frames,
                    TrialResult& result) {
  auto& v = result.values;
  const ObservationErrors& e = seen.errors;
  v["frames"] = static_cast<double>(frames.size());
  v["coverage"] = e.coverage_all;
  const Recovery recovery = CountRecoveries(frames);
  v["hidden"] = recovery.hidden;
  if (recovery.hidden > 0) {
    v["recovered_in_5"] = recovery.soon;
    v["recovery_frames"] = recovery.worst;
  }
  if (!seen.untracked.empty()) return;
  v["tip_median_mm"] = 1e3 * e.median_all;
  v["tip_95_mm"] = 1e3 * e.p95_all;
  for (int f = 0; f < kNumFingers; ++f) {
    if (e.counted[f] == 0) continue;
    v[fmt::format("{}_median_mm", kFingerNames[f])] = 1e3 * e.median[f];
    v[fmt::format("{}_95_mm", kFingerNames[f])] = 1e3 * e.p95[f];
  }
  if (e.wrist_coverage > 0) {
    v["hand_median_mm"] = 1e3 * e.wrist_median;
    v["hand_95_mm"] = 1e3 * e.wrist_p95;
  }
  if (e.rotation_coverage > 0) {
    v["hand_median_deg"] = e.wrist_rotation_median_deg;
    v["hand_95_deg"] = e.wrist_rotation_p95_deg;
  }
  v["swap_frames"] = e.swap_frames;
  v["swap_fraction"] = frames.empty() ? 0 : e.swap_frames / static_cast<double>(frames.size());
  v["epipolar_px"] = seen.summary.epipolar_px;
}

}  // namespace

std::string WhyUntracked(const Demonstration& demonstration, const PerFinger<bool>& involved) {
  const double end = demonstration.samples.back().t;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!involved[f]) continue;
    int seen = 0;
    double last = -1e9;
    for (const DemonstrationSample& sample : demonstration.samples) {
      if (!sample.p_WF[f]) continue;
      ++seen;
      last = sample.t;
    }
    const double share =
        static_cast<double>(seen) / static_cast<double>(demonstration.samples.size());
    if (share < kMinSeen) {
      return fmt::format("{} seen in {:.0f} % of the frames", kFingerNames[f], 100 * share);
    }
    if (end - last > kMaxUnseenEnd) {
      return fmt::format("{} not seen in the last {:.2f} s", kFingerNames[f], end - last);
    }
  }
  return "";
}

TrialResult RunObserveTrial(const TrialSpec& spec, const TrialOutput& output) {
  const auto begin = std::chrono::steady_clock::now();
  const auto file = [&](const char* name) {
    return (std::filesystem::path(output.folder) / name).string();
  };
  RandomEngine engine = MakeStream(spec.seed, spec.repetition, "observation");
  ObserveOptions observe;
  observe.fps = spec.scene.demonstrator.fps;
  observe.throw_untracked = false;
  if (output.overlay && !output.folder.empty()) observe.overlay = file("tracking.mp4");
  const Observation seen = Observe(spec.scene, engine, observe);
  const std::vector<TrackingFrame> frames = CompareFrames(seen.tracked, seen.truth, seen.visible);
  TrialResult result;
  result.phase = "observe";
  RecordTracking(seen, frames, result);
  if (output.trajectories && !output.folder.empty()) {
    WriteDemonstration(seen.tracked, file("demonstration.csv"));
    WriteDemonstration(seen.truth, file("truth.csv"));
    WriteFileAtomically(file("tracking.csv"), FormatTracking(frames));
  }
  result.message =
      seen.untracked.empty() ? WhyUntracked(seen.tracked, seen.shown.involved) : seen.untracked;
  result.outcome = result.message.empty() ? Outcome::kSuccess : Outcome::kUntracked;
  result.wall_s["observe"] =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace springgrasp
