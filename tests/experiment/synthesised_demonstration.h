// Synthesised demonstrations as exact fingertips plus noise, without cameras: many of them quickly.
#pragma once

#include <fmt/format.h>

#include <string>

#include "base/random.h"
#include "demonstration/demonstration.h"
#include "experiment/demonstrator_synthesise.h"
#include "sim/kinematic_tree_of.h"
#include "sim/scene_builder.h"

namespace springgrasp {

inline const DemonstratorHand& SharedHand() {
  static const DemonstratorHand hand = [] {
    BuildOptions options;
    options.with_robot = options.with_table = options.with_objects = false;
    options.with_demonstrator = true;
    const ModelPtr model = BuildModel(Scene{}, options);
    return MakeDemonstratorHand(KinematicTreeOf(*model, "mmm_hand"));
  }();
  return hand;
}

// The motion in its object's frame, 30 Hz; `noise` on every tip coordinate, m.
inline Demonstration SynthesisedDemonstration(const std::string& type, const Shape& shape,
                                              double noise, RandomEngine& engine) {
  SynthesiseOptions options;
  options.type = type;
  options.shape = shape;
  const HandMotion motion = Resampled(SynthesiseGrasp(SharedHand(), options, engine), 30);
  Demonstration out;
  out.source = motion.source;
  out.up = motion.up;
  out.object = motion.object;
  for (const HandMotionSample& shown : motion.samples) {
    const HandShape hand = ComputeHandShape(SharedHand(), shown.q);
    DemonstrationSample sample;
    sample.t = shown.t;
    sample.p_WH = shown.X_WH.translation();
    sample.R_WH = Eigen::Quaterniond(shown.X_WH.linear());
    for (int f = 0; f < kNumFingers; ++f) {
      const Eigen::Vector3d e(Normal(engine), Normal(engine), Normal(engine));
      sample.p_WF[f] = shown.X_WH * hand.tips[f] + noise * e;
      sample.confidence[f] = 1;
    }
    out.samples.push_back(sample);
  }
  return out;
}

// An object that a hand can hold that way, of random size.
inline Shape RandomObjectFor(const std::string& type, RandomEngine& engine) {
  const double u = Uniform01(engine);
  if (type == "pinch") return ParseShape(fmt::format("sphere:{:.4f}", 0.025 + 0.025 * u));
  if (type == "tripod") return ParseShape(fmt::format("sphere:{:.4f}", 0.035 + 0.02 * u));
  if (type == "power") return ParseShape(fmt::format("cylinder:{:.4f}x0.18", 0.04 + 0.025 * u));
  return ParseShape(fmt::format("box:{:.4f}x0.06x0.005", 0.07 + 0.02 * u));
}

}  // namespace springgrasp
