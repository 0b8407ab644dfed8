// The paper's filter (section III-B): one instance per view, whose particle is the set of the five
// candidate regions. Free functions over a plain set.
//
// What the paper leaves open, and the choice here:
//  - motion: each finger moves on by its last displacement; noise common to the hand plus noise of
//    each finger, because hands move more than fingers do within them;
//  - region: a disc of the cap's projected radius; histogram over hue and saturation;
//  - weight: exp(-(1 - mean Bhattacharyya) / colour_scale) times
//    exp(-sum of squared changes of the pairwise offsets / (2 posture_sigma^2)) per pair;
//  - resampling: systematic, every frame (the least variance for the least draws).
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "base/fingers.h"
#include "base/random.h"
#include "vision/marker_colour.h"

namespace springgrasp {

using Regions = PerFinger<Eigen::Vector2d>;  // centres, px

struct ParticleSet {
  std::vector<Regions> regions;
  std::vector<double> weights;   // sum to 1
  std::vector<Regions> scratch;  // resampling's second buffer
};

struct ParticleOptions {
  int count = 120;
  double common_sigma_px = 8;  // of the whole hand, per frame
  double finger_sigma_px = 3;  // of one finger within it
  double colour_scale = 0.04;
  double posture_sigma_px = 12;  // change of the offset between two fingers, per frame
};

// `count` copies of one configuration, equal weights.
ParticleSet MakeParticles(const Regions& start, int count);

// Moves every particle by `motion` (px per finger) and noise: 2 + 10 normals per particle, each one
// of 4096 quantiles, from three draws of the engine.
void PredictParticles(const Regions& motion, const ParticleOptions& options, RandomEngine& engine,
                      ParticleSet& particles);

// Weights by colour and posture. `bins` holds histogram bins; fingers not `active` (lost ones)
// count in neither. `radius_px` of each region; outside the picture a region has no pixels.
void WeightParticles(const cv::Mat& bins, const Histogram& model, const Regions& previous,
                     const Regions& motion, const PerFinger<bool>& active,
                     const PerFinger<double>& radius_px, const ParticleOptions& options,
                     ParticleSet& particles);

// Systematic resampling: one uniform draw. Weights are equal after it.
void ResampleParticles(RandomEngine& engine, ParticleSet& particles);

// Weighted mean of each region.
Regions MeanRegions(const ParticleSet& particles);

// Histogram of the disc about `centre`, up to 69 sample points of it; all zero outside the picture.
Histogram RegionHistogram(const cv::Mat& bins, const Eigen::Vector2d& centre, double radius_px);

}  // namespace springgrasp
