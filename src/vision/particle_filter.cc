#include "vision/particle_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

// The disc's points as whole pixels from its middle one, for one radius and one picture.
struct PixelDisc {
  std::array<int, kGrid * kGrid> du, dv, offset;
  int reach = 0;
};

PixelDisc MakePixelDisc(const cv::Mat& bins, double radius_px) {
  PixelDisc disc;
  const auto r = static_cast<float>(radius_px);
  for (int s = 0; s < kDisc.count; ++s) {
    disc.du[s] = static_cast<int>(std::floor(0.5F + r * kDisc.offset[s][0]));
    disc.dv[s] = static_cast<int>(std::floor(0.5F + r * kDisc.offset[s][1]));
    disc.offset[s] = disc.dv[s] * static_cast<int>(bins.step) + disc.du[s];
    disc.reach = std::max({disc.reach, std::abs(disc.du[s]), std::abs(disc.dv[s])});
  }
  return disc;
}

// Calls count(bin) for the disc's pixels about a centre, as far as they lie in the picture.
template <typename Count>
void VisitBins(const cv::Mat& bins, const Eigen::Vector2d& centre, const PixelDisc& disc,
               Count&& count) {
  const int u = static_cast<int>(std::floor(centre.x() + 0.5));
  const int v = static_cast<int>(std::floor(centre.y() + 0.5));
  const int reach = disc.reach;
  if (u >= reach && v >= reach && u < bins.cols - reach && v < bins.rows - reach) {
    const std::uint8_t* middle = bins.ptr(v) + u;
    for (int s = 0; s < kDisc.count; ++s) count(middle[disc.offset[s]]);
    return;
  }
  for (int s = 0; s < kDisc.count; ++s) {
    const int x = u + disc.du[s], y = v + disc.dv[s];
    if (x >= 0 && y >= 0 && x < bins.cols && y < bins.rows) count(bins.ptr(y)[x]);
  }
}

// Quantiles of the normal distribution: 16 random bits make a draw. A particle needs twelve, and
// logarithms for all of them cost as much as the rest of the filter.
class NormalTable {
 public:
  NormalTable() {
    double x = -5;
    for (int i = 0; i < kSize; ++i) {
      const double p = (i + 0.5) / kSize;
      for (int newton = 0; newton < 60; ++newton) {
        const double density = std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi);
        const double step = (0.5 * std::erfc(-x / std::numbers::sqrt2) - p) / density;
        x -= std::clamp(step, -0.5, 0.5);
        if (std::abs(step) < 1e-12) break;
      }
      quantile_[i] = x;
    }
  }
  double Of(std::uint64_t bits) const { return quantile_[bits & (kSize - 1)]; }

 private:
  static constexpr int kSize = 1 << 12;
  std::array<double, kSize> quantile_;
};

const NormalTable& Normals() {
  static const NormalTable table;
  return table;
}

}  // namespace

Histogram RegionHistogram(const cv::Mat& bins, const Eigen::Vector2d& centre, double radius_px) {
  Histogram histogram = {};
  const float share = 1.0F / static_cast<float>(kDisc.count);
  VisitBins(bins, centre, MakePixelDisc(bins, radius_px),
            [&](std::uint8_t bin) { histogram[bin] += share; });
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
  const NormalTable& normals = Normals();
  for (Regions& regions : particles.regions) {
    std::uint64_t bits = 0;
    int left = 0;
    const auto draw = [&] {
      if (left == 0) bits = engine(), left = 4;
      const double normal = normals.Of(bits);
      bits >>= 16;
      --left;
      return normal;
    };
    const double du = options.common_sigma_px * draw(), dv = options.common_sigma_px * draw();
    for (int f = 0; f < kNumFingers; ++f) {
      const double eu = options.finger_sigma_px * draw(), ev = options.finger_sigma_px * draw();
      regions[f] += motion[f] + Eigen::Vector2d(du + eu, dv + ev);
    }
  }
}

void WeightParticles(const cv::Mat& bins, const Histogram& model, const Regions& previous,
                     const Regions& motion, const PerFinger<bool>& active,
                     const PerFinger<double>& radius_px, const ParticleOptions& options,
                     ParticleSet& particles) {
  // Caps fill few bins; all others count as one that the model does not have.
  std::array<std::uint8_t, 256> slot = {};
  std::array<float, kHistogramBins + 1> root_model = {};
  int slots = 1;
  for (int b = 0; b < kHistogramBins; ++b) {
    if (model[b] <= 0) continue;
    root_model[slots] = std::sqrt(model[b]);
    slot[b] = static_cast<std::uint8_t>(slots++);
  }
  PerFinger<PixelDisc> discs;
  for (int f = 0; f < kNumFingers; ++f) {
    if (active[f]) discs[f] = MakePixelDisc(bins, radius_px[f]);
  }
  std::array<float, kGrid * kGrid + 1> root_count;
  for (std::size_t i = 0; i < root_count.size(); ++i) {
    root_count[i] = std::sqrt(static_cast<float>(i) / static_cast<float>(kDisc.count));
  }
  const double posture_scale = 0.5 / (options.posture_sigma_px * options.posture_sigma_px);
  double total = 0;
  std::array<std::uint16_t, kHistogramBins + 1> counts;
  for (std::size_t i = 0; i < particles.regions.size(); ++i) {
    const Regions& regions = particles.regions[i];
    double similarity = 0, bend = 0;
    int fingers = 0, pairs = 0;
    for (int f = 0; f < kNumFingers; ++f) {
      if (!active[f]) continue;
      ++fingers;
      std::fill_n(counts.begin(), slots, std::uint16_t{0});
      VisitBins(bins, regions[f], discs[f], [&](std::uint8_t bin) { ++counts[slot[bin]]; });
      float rho = 0;
      for (int b = 1; b < slots; ++b) rho += root_model[b] * root_count[counts[b]];
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
