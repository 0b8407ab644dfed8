#include "vision/particle_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "vision/mean_shift.h"

namespace springgrasp {
namespace {

const Regions kPlaces = {Eigen::Vector2d{60, 80}, {90, 40}, {120, 35}, {150, 40}, {175, 60}};

// Discs of bin 30 on bin 2.
cv::Mat DiscBins(const Regions& places, int radius) {
  cv::Mat bins(160, 240, CV_8UC1, cv::Scalar(2));
  for (const auto& place : places) {
    cv::circle(bins, {static_cast<int>(place.x()), static_cast<int>(place.y())}, radius, 30,
               cv::FILLED);
  }
  return bins;
}

PerFinger<double> Radius(double r) { return {r, r, r, r, r}; }
constexpr PerFinger<bool> kAll = {true, true, true, true, true};

TEST(ParticleFilterTest, TheEstimateFollowsCapsThatMoveTogether) {
  Histogram model = {};
  model[30] = 1;
  Regions truth = kPlaces, motion;
  motion.fill({0, 0});
  ParticleOptions options;
  ParticleSet particles = MakeParticles(kPlaces, options.count);
  RandomEngine engine = MakeStream(1, 0, "observation");
  Regions estimate = kPlaces;
  for (int frame = 0; frame < 10; ++frame) {
    for (auto& place : truth) place += Eigen::Vector2d(3, 2);
    PredictParticles(motion, options, engine, particles);
    WeightParticles(DiscBins(truth, 8), model, estimate, motion, kAll, Radius(8), options,
                    particles);
    const Regions next = MeanRegions(particles);
    for (int f = 0; f < kNumFingers; ++f) motion[f] = next[f] - estimate[f];
    estimate = next;
    ResampleParticles(engine, particles);
  }
  // Well within the window of the mean shift that follows, 1.3 radii.
  for (int f = 0; f < kNumFingers; ++f) EXPECT_LT((estimate[f] - truth[f]).norm(), 6) << f;
}

TEST(ParticleFilterTest, WeightsPreferTheRightPlaceAndTheKnownPosture) {
  Histogram model = {};
  model[30] = 1;
  Regions still;
  still.fill({0, 0});
  ParticleSet particles = MakeParticles(kPlaces, 3);
  for (auto& place : particles.regions[1]) place += Eigen::Vector2d(6, 0);  // beside the caps
  // Bent: index and middle have changed places, colours fit as well.
  std::swap(particles.regions[2][kIndex], particles.regions[2][kMiddle]);
  WeightParticles(DiscBins(kPlaces, 8), model, kPlaces, still, kAll, Radius(8), {}, particles);
  EXPECT_GT(particles.weights[0], 2 * particles.weights[1]);
  EXPECT_GT(particles.weights[0], 2 * particles.weights[2]);
  EXPECT_NEAR(particles.weights[0] + particles.weights[1] + particles.weights[2], 1, 1e-12);
}

TEST(ParticleFilterTest, SystematicResamplingCopiesInProportionToTheWeights) {
  ParticleSet particles = MakeParticles(kPlaces, 100);
  for (int i = 0; i < 100; ++i) {
    particles.regions[i][0].x() = i;
    particles.weights[i] = i == 17 ? 0.505 : 0.495 / 99;
  }
  RandomEngine engine = MakeStream(2, 0, "observation");
  ResampleParticles(engine, particles);
  int copies = 0;
  for (const Regions& regions : particles.regions) copies += regions[0].x() == 17;
  // Systematic: never more than one off the expectation.
  EXPECT_GE(copies, 50);
  EXPECT_LE(copies, 51);
}

TEST(ParticleFilterTest, EqualSeedsGiveEqualParticles) {
  ParticleSet a = MakeParticles(kPlaces, 20), b = a;
  Regions still;
  still.fill({0, 0});
  RandomEngine one = MakeStream(3, 0, "observation"), two = MakeStream(3, 0, "observation");
  PredictParticles(still, {}, one, a);
  PredictParticles(still, {}, two, b);
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(a.regions[i], b.regions[i]);
  EXPECT_NE(a.regions[0][0], kPlaces[0]);
}

TEST(MeanShiftTest, RegionsClimbToTheMiddleOfTheirCaps) {
  cv::Mat likelihood = DiscBins(kPlaces, 8);
  likelihood = (likelihood == 30);
  Regions start = kPlaces;
  for (auto& place : start) place += Eigen::Vector2d(5, -4);
  const MeanShiftResult modes = MeanShift(likelihood, start, kAll, Radius(10));
  for (int f = 0; f < kNumFingers; ++f) {
    EXPECT_LT((modes.centre[f] - kPlaces[f]).norm(), 0.2);
    EXPECT_NEAR(modes.mass[f], M_PI * 64, 20);
  }
}

TEST(MeanShiftTest, TwoRegionsDoNotClimbTheSameCap) {
  Regions places = kPlaces;
  places[1] = places[0] + Eigen::Vector2d(15, 0);  // nearly touching
  cv::Mat likelihood = (DiscBins(places, 8) == 30);
  Regions start = places;
  start[0].x() += 4;  // both start on the right one's side
  const MeanShiftResult modes = MeanShift(likelihood, start, kAll, Radius(10));
  EXPECT_LT((modes.centre[0] - places[0]).norm(), 2);
  EXPECT_LT((modes.centre[1] - places[1]).norm(), 2);
}

TEST(MeanShiftTest, WhereThereIsNothingTheRegionStaysWithoutMass) {
  const cv::Mat empty = cv::Mat::zeros(160, 240, CV_8UC1);
  const MeanShiftResult modes = MeanShift(empty, kPlaces, kAll, Radius(10));
  EXPECT_EQ(modes.centre[2], kPlaces[2]);
  EXPECT_EQ(modes.mass[2], 0);
}

}  // namespace
}  // namespace springgrasp
