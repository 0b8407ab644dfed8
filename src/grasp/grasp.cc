#include "grasp/grasp.h"

#include <fmt/format.h>

#include <iterator>
#include <limits>

#include "grasp/spring_estimation.h"

namespace springgrasp {
namespace {

SpringGains DemonstratedGains(const Grasp& grasp) {
  SpringGains gains;
  gains.mass = grasp.mass;
  gains.kc = grasp.kc;
  gains.dc = grasp.dc;
  for (const GraspEdge& edge : grasp.edges) {
    gains.k.push_back(edge.k);
    gains.d.push_back(edge.damping);
  }
  return gains;
}

}  // namespace

DimensionlessGains GainsOf(const Grasp& grasp) {
  DimensionlessGains gains = MakeDimensionless(DemonstratedGains(grasp), grasp.scales);
  gains.reach = grasp.reach_gain;
  gains.delay = grasp.delay;
  gains.closing = grasp.closing;
  gains.holding = grasp.holding;
  return gains;
}

SpringGains GainsFor(const Grasp& grasp, const ReachScales& scales) {
  return RestoreGains(GainsOf(grasp), grasp.mass, scales);
}

std::string ReportGrasp(const Grasp& grasp) {
  std::string out;
  auto to = std::back_inserter(out);
  const DimensionlessGains gains = GainsOf(grasp);
  fmt::format_to(to, "{} ({}, {}-D, {} profile) learned from {}\n", grasp.name, grasp.type,
                 grasp.dim, grasp.profile, grasp.source);
  fmt::format_to(to, "object: {} ({})\n", FormatShape(grasp.shape),
                 grasp.object_given ? "given" : "inferred");
  fmt::format_to(to, "reach: {:.3f} s, {:.3f} m, DMP RMSE {:.1f} mm\n", grasp.scales.T,
                 grasp.scales.A, 1e3 * grasp.quality.reach_rmse);
  fmt::format_to(to, "t_switch: {} at {:.2f} T\n", grasp.switch_rule, grasp.t_switch);
  for (const GraspEdge& edge : grasp.edges) {
    fmt::format_to(to, "k {}-{}: {:.4f}", kFingerNames[edge.i], kFingerNames[edge.j], edge.k);
    if (edge.standard_error > 0) {
      fmt::format_to(to, " +- {:.4f} N/m\n", edge.standard_error);
    } else {
      fmt::format_to(to, " N/m (not observed, assumed)\n");
    }
  }
  for (const GraspEdge& edge : grasp.edges) {
    const std::string name = fmt::format("{}-{}", kFingerNames[edge.i], kFingerNames[edge.j]);
    // A grasp has an error of 0 where there is none: the spring shows in no sample.
    const double error =
        edge.standard_error > 0 ? edge.standard_error : std::numeric_limits<double>::infinity();
    const std::string remark = RemarkOnSpring(name, edge.k, error);
    if (!remark.empty()) out += remark + "\n";
  }
  fmt::format_to(to, "condition number: {:.1f}\n", grasp.quality.condition_number);
  fmt::format_to(to,
                 "gains: gamma A/(m x0) {:.1f}, omega T {:.2f}, zeta {:.2f}, delay {:.2f} T, "
                 "closing {:.2f}, holding {:.2f}\n",
                 gains.reach, gains.omega_T, gains.zeta, gains.delay, gains.closing, gains.holding);
  const GraspQuality& quality = grasp.quality;
  fmt::format_to(to, "aperture: {:.1f} mm at {:.2f} T, reproduced {:.1f} mm at {:.2f} T\n",
                 1e3 * quality.aperture, quality.aperture_time, 1e3 * quality.aperture_reproduced,
                 quality.aperture_time_reproduced);
  if (grasp.dim == 2) {
    fmt::format_to(to, "planarity residual: {:.1f} mm\n", 1e3 * grasp.quality.planarity);
  }
  fmt::format_to(to, "measurement noise: {:.1f} mm\n", 1e3 * grasp.quality.noise);
  for (int i = 0; i < kNumFingers; ++i) {
    const std::string_view mark = grasp.involved[i] ? " *" : "";
    if (grasp.observed[i]) {
      fmt::format_to(to, "{} RMSE {:.1f} mm{}\n", kFingerNames[i], 1e3 * grasp.quality.rmse[i],
                     mark);
    } else {
      fmt::format_to(to, "{} not observed{}\n", kFingerNames[i], mark);
    }
  }
  out += "(* involved in the grasp)\n";
  return out;
}

}  // namespace springgrasp
