#include "kinematics/arm_choice.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

constexpr double kStep = 0.2;      // rad, between the swivels that are looked at first
constexpr double kPrecise = 1e-3;  // rad, of the best one
constexpr double kGolden = 0.6180339887498949;

}  // namespace

double ArmCost(const ArmGeometry& geometry, const ArmSolutions& solutions,
               const SwivelInterval& branch, double swivel, const SevenJoints& q,
               const ArmPreference& preference) {
  double limit = 0;
  for (int i = 0; i < 7; ++i) {
    const double half = 0.5 * (geometry.upper[i] - geometry.lower[i]);
    const double z = (q[i] - geometry.lower[i]) / half - 1;
    limit += z * z * z * z;
  }
  double cost = preference.limit * limit;
  if (preference.elbow > 0) {
    cost += preference.elbow * 0.5 * (1 + solutions.ElbowHeight(branch, swivel));
  }
  if (preference.step > 0) cost += preference.step * (q - preference.near).squaredNorm();
  return cost;
}

std::optional<ArmChoice> ChoosePosture(const ArmGeometry& geometry, const ArmSolutions& solutions,
                                       const ArmPreference& preference) {
  std::optional<ArmChoice> best;
  double best_from = 0, best_to = 0;
  const auto at = [&](const SwivelInterval& branch, double swivel) {
    ArmChoice choice;
    choice.branch = branch;
    choice.swivel = swivel;
    choice.q = solutions.JointsAt(branch, swivel);
    choice.cost = ArmCost(geometry, solutions, branch, swivel, choice.q, preference);
    return choice;
  };
  for (const SwivelInterval& interval : solutions.intervals()) {
    const double width = interval.to - interval.from;
    const int steps = std::max(2, static_cast<int>(std::ceil(width / kStep)));
    for (int i = 0; i <= steps; ++i) {
      ArmChoice choice = at(interval, interval.from + width * i / steps);
      if (best && choice.cost >= best->cost) continue;
      best = choice;
      best_from = std::max(interval.from, choice.swivel - width / steps);
      best_to = std::min(interval.to, choice.swivel + width / steps);
    }
  }
  if (!best) return best;
  // Golden section about the best.
  double a = best_from, b = best_to;
  ArmChoice left = at(best->branch, b - kGolden * (b - a));
  ArmChoice right = at(best->branch, a + kGolden * (b - a));
  while (b - a > kPrecise) {
    if (left.cost < right.cost) {
      b = right.swivel;
      right = left;
      left = at(best->branch, b - kGolden * (b - a));
    } else {
      a = left.swivel;
      left = right;
      right = at(best->branch, a + kGolden * (b - a));
    }
  }
  for (const ArmChoice& choice : {left, right}) {
    if (choice.cost < best->cost) best = choice;
  }
  best->q = best->q.cwiseMax(geometry.lower).cwiseMin(geometry.upper);
  return best;
}

}  // namespace springgrasp
