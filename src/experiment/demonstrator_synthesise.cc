#include "experiment/demonstrator_synthesise.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "experiment/demonstrator_grasp.h"
#include "grasp/object_contacts.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr double kMaxGap = 0.001;          // m, of a fingertip from its place on the surface
constexpr double kMaxPenetration = 0.002;  // m

// The two-parameter family "how a person does it this time"; drawn in this order.
struct Style {
  double duration, distance, peak, aperture, azimuth, elevation, curvature, start_still;
  Eigen::Vector3d turn;  // rad, of the hand at the start
  GraspStyle grasp;
};

Style DrawStyle(RandomEngine& engine) {
  Style style;
  style.duration = Uniform(engine, 1.0, 1.4);
  style.distance = Uniform(engine, 0.25, 0.35);
  style.peak = Uniform(engine, 0.60, 0.75);
  style.aperture = 0.003 * Normal(engine);
  style.azimuth = Uniform(engine, -0.2, 0.2);
  style.elevation = Uniform(engine, -0.15, 0.15);
  style.curvature = Uniform(engine, 0.7, 1.3);
  style.start_still = Uniform(engine, 0.05, 0.15);
  for (int i = 0; i < 3; ++i) style.turn[i] = Uniform(engine, -0.1, 0.1);
  style.grasp.height = Uniform(engine, -0.003, 0.003);
  style.grasp.pitch = Uniform(engine, -0.12, 0.12);
  style.grasp.roll = Uniform(engine, -0.08, 0.08);
  return style;
}

// Where the hand comes from (unit), how the path bows, and its turn at the start, per type.
struct Approach {
  Eigen::Vector3d from, bow, turn;
};

Approach ApproachOf(const std::string& type, bool from_above) {
  if (from_above) {
    // From the right and behind, over the object, the last part from above.
    return {{0.9, 0.1, 0.25}, {0, 0, 0.16}, {0.0, -0.1, -0.25}};
  }
  if (type != "lateral") return {{0.95, 0.1, -0.2}, {-0.1, 0.22, 0.0}, {0.1, 0.15, 0.0}};
  return {{0.95, 0.05, -0.25}, {0.0, 0.05, 0.05}, {0.1, 0.15, 0.0}};
}

// The hand open around the object: from the held posture, thumb and involved fingers stretched.
Eigen::VectorXd SpreadPosture(const DemonstratorHand& hand, const HeldPosture& held,
                              const std::string& type) {
  Eigen::VectorXd q = held.q;
  for (int f = 0; f < kNumFingers; ++f) {
    if (!held.involved[f]) continue;
    const std::string name = "mmm_" + std::string(kFingerNames[f]);
    const auto set = [&](const char* joint, double angle) {
      double& value = q[hand.tree.JointIndex(name + joint)];
      value = std::min(value, angle);
    };
    if (f == kThumb) {
      set("_cmc_flexion", -0.6);
      set("_mcp", 0.05);
      set("_ip", 0.05);
    } else if (type != "lateral") {
      set("_mcp", 0.25);
      set("_pip", 0.25);
      set("_dip", 0.1);
    }
  }
  if (type == "lateral") {
    double& opposition = q[hand.tree.JointIndex("mmm_thumb_cmc_opposition")];
    opposition = std::min(opposition, 0.4);
  }
  return q;
}

double Aperture(const DemonstratorHand& hand, const Eigen::VectorXd& q) {
  const HandShape shape = ComputeHandShape(hand, q);
  return (shape.tips[kThumb] - shape.tips[kIndex]).norm();
}

// Between `a` (narrower) and `b` (wider), the posture of the wanted aperture; b if out of reach.
Eigen::VectorXd PostureOfAperture(const DemonstratorHand& hand, const Eigen::VectorXd& a,
                                  const Eigen::VectorXd& b, double aperture) {
  double low = 0, high = 1;
  for (int i = 0; i < 40; ++i) {
    const double middle = (low + high) / 2;
    (Aperture(hand, a + middle * (b - a)) < aperture ? low : high) = middle;
  }
  return a + high * (b - a);
}

// The dimension of the object between thumb and fingers.
double GripSize(const DemonstratorHand& hand, const HeldPosture& held) {
  return Aperture(hand, held.q) - 2 * hand.tip_radius;
}

// A hand about to grasp is nearly closed: as if it held something smaller, its caps just apart.
Eigen::VectorXd StartPosture(const DemonstratorHand& hand, const HeldPosture& held,
                             const SynthesiseOptions& options, const Eigen::VectorXd& spread) {
  constexpr double kSmaller = 0.65, kGap = 0.015;  // m, between the caps
  const double least_aperture = 2 * hand.size.cap_radius + kGap;
  if (Aperture(hand, held.q) < least_aperture) {
    return PostureOfAperture(hand, held.q, spread, least_aperture);
  }
  Shape smaller = options.shape;
  smaller.size *= kSmaller;
  GraspStyle style;
  style.approach = options.approach;
  return SolveHeldPosture(hand, options.type, smaller, style).q;
}

// The whole movement. `bow` scales the path's curvature, `wider` is added to the peak aperture, m.
std::vector<HandMotionSample> Perform(const DemonstratorHand& hand, const HeldPosture& held,
                                      const SynthesiseOptions& options, const Style& style,
                                      const Approach& approach, double bow_scale, double wider) {
  const double peak_aperture = 0.051 + 0.67 * GripSize(hand, held) + style.aperture + wider;
  const Eigen::VectorXd spread = SpreadPosture(hand, held, options.type);
  const Eigen::VectorXd q_peak = PostureOfAperture(hand, held.q, spread, peak_aperture);
  const Eigen::VectorXd q_start = StartPosture(hand, held, options, spread);
  const Eigen::Quaterniond azimuth(Eigen::AngleAxisd(style.azimuth, Eigen::Vector3d::UnitZ()));
  Eigen::Vector3d from = azimuth * approach.from;
  from.z() += style.elevation;
  from *= style.distance / from.norm();
  const Eigen::Vector3d bow =
      azimuth * approach.bow * (bow_scale * style.curvature * style.distance);
  const Eigen::Quaterniond R_end(held.X_OH.linear());
  const Eigen::Vector3d turn = approach.turn + style.turn;

  std::vector<HandMotionSample> samples;
  const double total = style.start_still + style.duration + options.hold;
  const int steps = static_cast<int>(std::ceil(total * options.rate));
  for (int i = 0; i <= steps; ++i) {
    HandMotionSample sample;
    sample.t = i / options.rate;
    const double s = std::clamp((sample.t - style.start_still) / style.duration, 0.0, 1.0);
    const double m = MinimumJerkPosition(s);
    const Eigen::Vector3d p = held.X_OH.translation() + (1 - m) * from + 4 * m * (1 - m) * bow;
    sample.X_WH = MakePose(p, ExpRotation((1 - m) * turn) * R_end);
    const double opening = MinimumJerkPosition(std::min(1.0, s / style.peak));
    const double closing = MinimumJerkPosition(std::max(0.0, (s - style.peak) / (1 - style.peak)));
    sample.q = q_start + opening * (q_peak - q_start) + closing * (held.q - q_peak);
    sample.wrist_recorded = true;
    sample.recorded.fill(true);
    samples.push_back(sample);
  }
  return samples;
}

// Deepest point of any finger in the object (at its origin) over the movement, m.
double PathPenetration(const DemonstratorHand& hand, const Shape& shape,
                       const std::vector<HandMotionSample>& samples) {
  double depth = 0;
  std::vector<Pose> bodies;
  HandShape parts;
  for (std::size_t i = 0; i < samples.size(); i += 3) {
    ComputeHandShape(hand, samples[i].q, bodies, parts);
    for (const auto& chain : parts.chains) {
      for (std::size_t k = 1; k < chain.size(); ++k) {
        for (const Eigen::Vector3d& p_H :
             {chain[k], Eigen::Vector3d((chain[k] + chain[k - 1]) / 2)}) {
          depth = std::max(depth, hand.tip_radius - SignedDistance(shape, samples[i].X_WH * p_H));
        }
      }
    }
  }
  return depth;
}

}  // namespace

HandMotion SynthesiseGrasp(const DemonstratorHand& hand, const SynthesiseOptions& options,
                           RandomEngine& engine) {
  Style style = DrawStyle(engine);
  style.grasp.approach = options.approach;
  const HeldPosture held = SolveHeldPosture(hand, options.type, options.shape, style.grasp);
  ThrowUnless(held.worst_gap < kMaxGap && held.worst_penetration < kMaxPenetration,
              "a hand of {:.0f} mm cannot hold {} by a {} grasp (fingertips {:.0f} mm off)",
              1000 * hand.size.length, FormatShape(options.shape), options.type,
              1000 * std::max(held.worst_gap, held.worst_penetration));

  const Approach approach =
      ApproachOf(options.type, ComesFromAbove(options.type, options.approach));
  HandMotion motion;
  motion.source = "synthesised " + options.type;
  motion.type = options.type;
  motion.joint_names = hand.tree.joint_names;
  motion.involved = held.involved;
  motion.object = DemonstratedObject{options.shape, Pose::Identity()};
  motion.comments = {
      fmt::format("demonstration: synthesised {} of {}", options.type, FormatShape(options.shape))};
  // A person avoids the object: open wider and come more from the hand's side until it is clear.
  double least = 1e9;
  std::vector<HandMotionSample> best;
  for (const double bow : {1.0, 1.5, 2.0, 2.5}) {
    for (const double wider : {0.0, 0.006, 0.012}) {
      std::vector<HandMotionSample> samples =
          Perform(hand, held, options, style, approach, bow, wider);
      const double depth = PathPenetration(hand, options.shape, samples);
      if (depth < least - 1e-4) {
        least = depth;
        best = std::move(samples);
      }
      if (least < kMaxPenetration) break;
    }
    if (least < kMaxPenetration) break;
  }
  motion.samples = std::move(best);
  return motion;
}

}  // namespace springgrasp
