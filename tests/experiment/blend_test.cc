// From any grasp of the shipped library to any other there is a continuous path of grasps.
#include "grasp/blend.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/error.h"
#include "experiment/synthesised_demonstration.h"
#include "grasp/generate.h"
#include "grasp/library.h"
#include "kinematics/hand_ik.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

const std::vector<LibraryEntry>& Library() {
  static const std::vector<LibraryEntry> library = ReadLibrary(ShippedLibrary());
  return library;
}

GenerateOptions OnABall() {
  GenerateOptions options;
  options.shape = ParseShape("sphere:0.04");
  options.duration = 1.2;
  options.dt = 0.02;
  return options;
}

FingertipMotion Between(const Grasp& a, const Grasp& b, double s) {
  const GenerateOptions options = OnABall();
  return GenerateMotion(BlendGrasps(a, b, s, options.shape, options.tip_radius), options);
}

// Largest distance between the tips of two motions at the same time, in H, m.
double Distance(const FingertipMotion& a, const FingertipMotion& b) {
  double distance = 0;
  for (std::size_t n = 0; n < a.samples.size(); ++n) {
    for (int i = 0; i < kNumFingers; ++i) {
      distance = std::max(distance, (a.samples[n].p_HF[i] - b.samples[n].p_HF[i]).norm());
    }
  }
  return distance;
}

TEST(BlendGrasps, EndsAreTheTwoGraspsThemselves) {
  const GenerateOptions options = OnABall();
  for (const LibraryEntry& a : Library()) {
    for (const LibraryEntry& b : Library()) {
      SCOPED_TRACE(a.grasp.name + " to " + b.grasp.name);
      EXPECT_LT(Distance(Between(a.grasp, b.grasp, 0), GenerateMotion(a.grasp, options)), 1e-9);
      EXPECT_LT(Distance(Between(a.grasp, b.grasp, 1), GenerateMotion(b.grasp, options)), 1e-9);
    }
  }
}

// No jump anywhere, the ends included: where the fingertips change fastest, smaller steps change
// them less.
TEST(BlendGrasps, FingertipsMoveContinuouslyFromOneGraspToTheOther) {
  constexpr int kSteps = 12, kParts = 12;
  for (const LibraryEntry& a : Library()) {
    for (const LibraryEntry& b : Library()) {
      if (a.grasp.name >= b.grasp.name) continue;
      SCOPED_TRACE(a.grasp.name + " to " + b.grasp.name);
      const auto steepest = [&](double from, double to, int steps) {
        double most = 0, at = from;
        FingertipMotion last = Between(a.grasp, b.grasp, from);
        for (int k = 1; k <= steps; ++k) {
          const double s = from + (to - from) * k / steps;
          const FingertipMotion motion = Between(a.grasp, b.grasp, s);
          const double change = Distance(last, motion);
          if (change > most) {
            most = change;
            at = s - (to - from) / steps;
          }
          last = motion;
        }
        return std::pair(most, at);
      };
      const auto [most, at] = steepest(0, 1, kSteps);
      EXPECT_LT(most, 0.025) << "m, at " << at;
      EXPECT_LT(steepest(at, at + 1.0 / kSteps, kParts).first, 0.5 * most) << "at " << at;
    }
  }
}

struct Along {
  double nearest = 1;  // m, of two fingertips
  double order = 1;    // m, by which a finger stays on the thumb's side of the next
  double off = 0;      // m, of a tip from what the human hand reaches within its joints' ranges
};

// Of one grasp of the path; `postures` warm-starts the hand and takes what it found.
Along Look(const HumanHand& human, const FingertipMotion& motion, std::vector<VectorXd>& postures) {
  Along along;
  postures.resize(motion.samples.size());
  for (std::size_t n = 0; n < motion.samples.size(); n += 8) {
    const auto& tips = motion.samples[n].p_HF;
    KnownTips known;
    for (int i = 0; i < kNumFingers; ++i) {
      known[i] = tips[i];
      for (int j = 0; j < i; ++j) {
        along.nearest = std::min(along.nearest, (tips[i] - tips[j]).norm());
      }
      if (i > kIndex) along.order = std::min(along.order, tips[i - 1].y() - tips[i].y());
    }
    if (postures[n].size() == 0 && n > 0) postures[n] = postures[n - 8];
    const HandIkResult hand = SolveHandIk(human, known, postures[n]);
    postures[n] = hand.q;
    for (const double error : hand.error) along.off = std::max(along.off, error);
  }
  return along;
}

TEST(BlendGrasps, FingertipsNeverCrossAndTheHumanHandReachesThem) {
  const HumanHand human = MakeHumanHand(SharedHand().tree);
  for (const LibraryEntry& a : Library()) {
    for (const LibraryEntry& b : Library()) {
      if (a.grasp.name >= b.grasp.name) continue;
      SCOPED_TRACE(a.grasp.name + " to " + b.grasp.name);
      std::vector<VectorXd> postures;
      std::vector<Along> path;
      for (int k = 0; k <= 8; ++k) {
        path.push_back(Look(human, Between(a.grasp, b.grasp, k / 8.0), postures));
      }
      Along worst, ends;
      for (const Along& along : path) {
        worst.nearest = std::min(worst.nearest, along.nearest);
        worst.order = std::min(worst.order, along.order);
        worst.off = std::max(worst.off, along.off);
      }
      for (const Along& along : {path.front(), path.back()}) {
        ends.nearest = std::min(ends.nearest, along.nearest);
        ends.order = std::min(ends.order, along.order);
        ends.off = std::max(ends.off, along.off);
      }
      // In between no closer than where the path begins or ends, and each on its side of the next.
      EXPECT_GT(worst.nearest, std::min(0.008, ends.nearest - 0.0015));
      EXPECT_GT(worst.order, ends.order - 0.006);
      // A lateral grasp of a ball is not easy for a hand to begin with.
      const bool lateral = a.grasp.type == "lateral" || b.grasp.type == "lateral";
      EXPECT_LT(worst.off, lateral ? 0.030 : 0.010);
    }
  }
}

TEST(BlendGrasps, AGraspInBetweenCanBeWrittenAndRead) {
  const GenerateOptions options = OnABall();
  const Grasp grasp =
      BlendGrasps(Library()[1].grasp, Library()[3].grasp, 0.3, options.shape, options.tip_radius);
  const Grasp read = ParseGrasp(FormatGrasp(grasp), "grasp");
  EXPECT_EQ(read.share, grasp.share);
  EXPECT_LT(Distance(GenerateMotion(read, options), GenerateMotion(grasp, options)), 1e-9);
}

TEST(BlendGrasps, WhatCannotBeBlendedIsAnError) {
  Grasp a = Library()[0].grasp, b = Library()[1].grasp;
  EXPECT_THROW(BlendGrasps(a, b, 1.5, a.shape, 0.008), Error);
  b.dim = 2;
  EXPECT_THROW(BlendGrasps(a, b, 0.5, a.shape, 0.008), Error);
}

}  // namespace
}  // namespace springgrasp
