// The tracker's pairs of frames per second on stored 640x480 pictures, beside the plain pipeline
// that OpenCV's users begin with; and what tracking adds to rendering a live scene.
#include <benchmark/benchmark.h>

#include <array>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "base/files.h"
#include "experiment/observe.h"

namespace springgrasp {
namespace {

// One demonstration as both eyes see it, drawn once.
struct Recording {
  Scene scene = ReadScene(SourceFolder() + "/scenes/pinch_ball.yaml");
  ObserveStage stage{scene, ShownShape(scene)};
  HandMotion motion;
  std::vector<StereoFrame> frames;

  Recording() {
    RandomEngine engine = MakeStream(1, 0, "observation");
    motion = Resampled(PrepareDemonstration(scene, stage, engine), 30);
    for (const HandMotionSample& sample : motion.samples) frames.push_back(Draw(sample));
  }
  StereoFrame Draw(const HandMotionSample& sample) {
    stage.Show(sample, motion.object);
    return {sample.t, stage.Picture(0), stage.Picture(1)};
  }
};

Recording& TheRecording() {
  static Recording recording;
  return recording;
}

void CountPairs(benchmark::State& state, std::size_t per_iteration) {
  state.counters["pairs_per_s"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * double(per_iteration), benchmark::Counter::kIsRate);
}

// BGR to HSV of both pictures, back-projection of the caps' hue, one mean shift per finger and
// view.
void PlainOpenCv(benchmark::State& state) {
  Recording& recording = TheRecording();
  cv::setNumThreads(1);
  FingertipTracker start(recording.stage.eyes(), {});
  const auto first = start.Start(recording.frames[0].left, recording.frames[0].right);
  if (!first) return state.SkipWithError("no caps in the first frame");
  std::array<PerFinger<cv::Rect>, 2> windows;
  for (int v = 0; v < 2; ++v) {
    for (int f = 0; f < kNumFingers; ++f) {
      const Eigen::Vector2d at = *first->fingers[f].pixel[v];
      windows[v][f] = {static_cast<int>(at.x()) - 12, static_cast<int>(at.y()) - 12, 24, 24};
    }
  }
  const int bins = 32, channel = 0;
  const float hues[] = {0, 180};
  const float* ranges[] = {hues};
  cv::Mat hsv, histogram, probability;
  cv::cvtColor(recording.frames[0].left, hsv, cv::COLOR_BGR2HSV);
  const cv::Mat cap = hsv(windows[0][kMiddle]);
  cv::calcHist(&cap, 1, &channel, {}, histogram, 1, &bins, ranges);
  cv::normalize(histogram, histogram, 0, 255, cv::NORM_MINMAX);
  const cv::TermCriteria criteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 10, 1);
  for (auto _ : state) {
    auto at = windows;
    for (std::size_t i = 1; i < recording.frames.size(); ++i) {
      for (int v = 0; v < 2; ++v) {
        const cv::Mat& picture = v == 0 ? recording.frames[i].left : recording.frames[i].right;
        cv::cvtColor(picture, hsv, cv::COLOR_BGR2HSV);
        cv::calcBackProject(&hsv, 1, &channel, histogram, probability, ranges);
        for (cv::Rect& window : at[v]) cv::meanShift(probability, window, criteria);
      }
    }
    benchmark::DoNotOptimize(at);
  }
  CountPairs(state, recording.frames.size() - 1);
}

void Fingertips(benchmark::State& state, TrackerKind kind) {
  Recording& recording = TheRecording();
  cv::setNumThreads(1);
  TrackerOptions options;
  options.kind = kind;
  TrackerTimes times;
  for (auto _ : state) {
    state.PauseTiming();
    RandomEngine engine = MakeStream(1, 0, "observation");
    FingertipTracker tracker(recording.stage.eyes(), options);
    tracker.Start(recording.frames[0].left, recording.frames[0].right);
    state.ResumeTiming();
    for (std::size_t i = 1; i < recording.frames.size(); ++i) {
      benchmark::DoNotOptimize(
          tracker.Update(recording.frames[i].left, recording.frames[i].right, engine));
    }
    times += tracker.times();
  }
  CountPairs(state, recording.frames.size() - 1);
  const double pairs =
      static_cast<double>(state.iterations()) * double(recording.frames.size() - 1);
  for (std::size_t i = 0; i < times.seconds.size(); ++i) {
    state.counters[std::string(kTrackerStages[i]) + "_us"] = 1e6 * times.seconds[i] / pairs;
  }
}

// With the pose of the hand, as `observe` tracks; its start, slow and once only, in it.
void FingertipsAndHand(benchmark::State& state) {
  Recording& recording = TheRecording();
  cv::setNumThreads(1);
  TrackDemonstrationOptions options;
  options.object = recording.motion.object;
  for (auto _ : state) {
    RandomEngine engine = MakeStream(1, 0, "observation");
    std::size_t next = 0;
    const FrameSource source = [&]() -> std::optional<StereoFrame> {
      if (next == recording.frames.size()) return std::nullopt;
      return recording.frames[next++];
    };
    benchmark::DoNotOptimize(TrackStereo(source, recording.stage.eyes(),
                                         &recording.stage.common_hand(), options, engine));
  }
  CountPairs(state, recording.frames.size());
}

void RenderBothViews(benchmark::State& state) {
  Recording& recording = TheRecording();
  for (auto _ : state) {
    for (const HandMotionSample& sample : recording.motion.samples) {
      benchmark::DoNotOptimize(recording.Draw(sample));
    }
  }
  CountPairs(state, recording.motion.samples.size());
}

void RenderAndTrack(benchmark::State& state) {
  Recording& recording = TheRecording();
  ObserveOptions options;
  options.measure_visible = false;
  for (auto _ : state) {
    RandomEngine engine = MakeStream(1, 0, "observation");
    benchmark::DoNotOptimize(ObserveMotion(recording.stage, recording.motion, engine, options));
  }
  CountPairs(state, recording.motion.samples.size());
}

BENCHMARK(PlainOpenCv)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Fingertips, outline, TrackerKind::kOutline)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Fingertips, paper, TrackerKind::kPaper)->Unit(benchmark::kMillisecond);
BENCHMARK(FingertipsAndHand)->Unit(benchmark::kMillisecond);
BENCHMARK(RenderBothViews)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(RenderAndTrack)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace springgrasp
