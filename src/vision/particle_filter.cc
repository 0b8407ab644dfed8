#include "vision/particle_filter.h"

#include <array>
#include <cmath>

namespace springgrasp {
namespace {

// Grid points of the unit disc at which regions are sampled.
constexpr int kGrid = 9;

struct DiscSamples {
  std::array<std::array<float, 2>, kGrid * kGrid> offset;
  int count = 0;
};

DiscSamples MakeDiscSamples() {
  DiscSamples samples;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const float x = 2.0F * static_cast<float>(i) / (kGrid - 1) - 1;
      const float y = 2.0F * static_cast<float>(j) / (kGrid - 1) - 1;
      if (x * x + y * y <= 1.13F) samples.offset[samples.count++] = {x * 0.94F, y * 0.94F};
    }
  }
  return samples;
}

const DiscSamples kDisc = MakeDiscSamples();

// Counts of the bins about a centre; returns how many samples fell into the picture.
int CountBins(const cv::Mat& bins, const Eigen::Vector2d& centre, double radius_px,
              std::array<std::uint16_t, kHistogramBins>& counts) {
  counts.fill(0);
  int inside = 0;
  const auto cx = static_cast<float>(centre.x()) + 0.5F, cy = static_cast<float>(centre.y()) + 0.5F;
  const auto r = static_cast<float>(radius_px);
  for (int s = 0; s < kDisc.count; ++s) {
    const int u = static_cast<int>(std::floor(cx + r * kDisc.offset[s][0]));
    const int v = static_cast<int>(std::floor(cy + r * kDisc.offset[s][1]));
    if (u < 0 || v < 0 || u >= bins.cols || v >= bins.rows) continue;
    ++counts[bins.ptr(v)[u]];
    ++inside;
  }
  return inside;
}

}  // namespace

Histogram RegionHistogram(const cv::Mat& bins, const Eigen::Vector2d& centre, double radius_px) {
  std::array<std::uint16_t, kHistogramBins> counts;
  Histogram histogram = {};
  if (CountBins(bins, centre, radius_px, counts) == 0) return histogram;
  for (int b = 0; b < kHistogramBins; ++b) {
    histogram[b] = static_cast<float>(counts[b]) / static_cast<float>(kDisc.count);
  }
  return histogram;
}

ParticleSet MakeParticles(const Regions& start, int count) {
  ParticleSet particles;
  particles.regions.assign(count, start);
  particles.scratch.assign(count, start);
  particles.weights.assign(count, 1.0 / count);
  return particles;
}

void PredictParticles(const Regions& motion, const ParticleOptions& options, RandomEngine& engine,
                      ParticleSet& particles) {
  for (Regions& regions : particles.regions) {
    const double du = options.common_sigma_px * Normal(engine);
    const double dv = options.common_sigma_px * Normal(engine);
    for (int f = 0; f < kNumFingers; ++f) {
      const double eu = options.finger_sigma_px * Normal(engine);
      const double ev = options.finger_sigma_px * Normal(engine);
      regions[f] += motion[f] + Eigen::Vector2d(du + eu, dv + ev);
    }
  }
}

void WeightParticles(const cv::Mat& bins, const Histogram& model, const Regions& previous,
                     const Regions& motion, const PerFinger<bool>& active,
                     const PerFinger<double>& radius_px, const ParticleOptions& options,
                     ParticleSet& particles) {
  Histogram root_model;
  for (int b = 0; b < kHistogramBins; ++b) root_model[b] = std::sqrt(model[b]);
  std::array<float, kGrid * kGrid + 1> root_count;
  for (std::size_t i = 0; i < root_count.size(); ++i) {
    root_count[i] = std::sqrt(static_cast<float>(i) / static_cast<float>(kDisc.count));
  }
  const double posture_scale = 0.5 / (options.posture_sigma_px * options.posture_sigma_px);
  double total = 0;
  std::array<std::uint16_t, kHistogramBins> counts;
  for (std::size_t i = 0; i < particles.regions.size(); ++i) {
    const Regions& regions = particles.regions[i];
    double similarity = 0, bend = 0;
    int fingers = 0, pairs = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      if (!active[f]) continue;
      ++fingers;
      CountBins(bins, regions[f], radius_px[f], counts);
      float rho = 0;
      for (int b = 0; b < kHistogramBins; ++b) rho += root_model[b] * root_count[counts[b]];
      similarity += rho;
      for (int g = 0; g < f; ++g) {
        if (!active[g]) continue;
        const Eigen::Vector2d change =
            (regions[f] - regions[g]) - (previous[f] + motion[f] - previous[g] - motion[g]);
        bend += change.squaredNorm();
        ++pairs;
      }
    }
    const double colour = fingers > 0 ? 1 - similarity / fingers : 0;
    const double posture = pairs > 0 ? posture_scale * bend / pairs : 0;
    particles.weights[i] = std::exp(-colour / options.colour_scale - posture);
    total += particles.weights[i];
  }
  const double uniform = 1.0 / static_cast<double>(particles.weights.size());
  for (double& weight : particles.weights) weight = total > 1e-280 ? weight / total : uniform;
}

void ResampleParticles(RandomEngine& engine, ParticleSet& particles) {
  const std::size_t n = particles.regions.size();
  particles.scratch.resize(n);
  const double step = 1.0 / static_cast<double>(n);
  double at = Uniform01(engine) * step, sum = particles.weights[0];
  std::size_t source = 0;
  for (std::size_t i = 0; i < n; ++i, at += step) {
    while (at > sum && source + 1 < n) sum += particles.weights[++source];
    particles.scratch[i] = particles.regions[source];
  }
  particles.regions.swap(particles.scratch);
  particles.weights.assign(n, step);
}

Regions MeanRegions(const ParticleSet& particles) {
  Regions mean;
  mean.fill(Eigen::Vector2d::Zero());
  for (std::size_t i = 0; i < particles.regions.size(); ++i) {
    for (int f = 0; f < kNumFingers; ++f) mean[f] += particles.weights[i] * particles.regions[i][f];
  }
  return mean;
}

}  // namespace springgrasp
