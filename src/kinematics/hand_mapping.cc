#include "kinematics/hand_mapping.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kinematics/mapping_problem.h"

namespace springgrasp {
namespace {

const std::array<Eigen::Vector2d, 4> kOtherStarts = {
    Eigen::Vector2d(0.1, 0.9), Eigen::Vector2d(0.9, 0.1), Eigen::Vector2d(0.3, 0.3),
    Eigen::Vector2d(0.8, 0.8)};  // of the ranges of j0, j1

// Solution of A y = b by A = L D L', its loops of fixed length so that they are unrolled; only A's
// lower part is read. False: A is not positive definite.
bool SolveFixed(const ValveMatrix& A, const ValveAngles& b, ValveAngles& y) {
  double L[kMostValves][kMostValves], inverse[kMostValves];
  for (int i = 0; i < kMostValves; ++i) {
    double scaled[kMostValves];  // L(i, .) D
    double pivot = A(i, i);
    for (int j = 0; j < i; ++j) {
      double sum = A(i, j);
      for (int k = 0; k < j; ++k) sum -= scaled[k] * L[j][k];
      scaled[j] = sum;
      L[i][j] = sum * inverse[j];
      pivot -= sum * L[i][j];
    }
    if (!(pivot > 0)) return false;
    inverse[i] = 1 / pivot;
  }
  for (int i = 0; i < kMostValves; ++i) {
    double sum = b[i];
    for (int k = 0; k < i; ++k) sum -= L[i][k] * y[k];
    y[i] = sum;
  }
  for (int i = kMostValves - 1; i >= 0; --i) {
    double sum = y[i] * inverse[i];
    for (int k = i + 1; k < kMostValves; ++k) sum -= L[k][i] * y[k];
    y[i] = sum;
  }
  return true;
}

// Projected Levenberg-Marquardt as in levenberg_marquardt.h, on the normal equations alone, with
// the whole second derivatives where these are positive definite: where a tip is out of reach,
// Gauss-Newton takes tens of steps.
MappingSolution Minimize(MappingProblem& problem, const ValveAngles& start, int max_iterations) {
  constexpr double kStep = 3e-5;      // rad, where it ends
  constexpr double kGradient = 1e-9;  // of the cost, per rad
  // rad along a step; across it much more may be left: with 3e-6 nine times as many frames are worse
  // than by SLSQP, with this as many as without (bench/kinematics_bench).
  constexpr double kLeft = 1.5e-7;
  MappingSolution best;
  best.x = start;
  best.cost = problem.Cost(best.x);
  best.squared_tip_errors = problem.squared_tip_errors();
  MappingProblem::Derivatives d;
  ValveMatrix whole;
  double damping = 1e-4, growth = 2;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    problem.Differentiate(d);
    whole = d.A + d.B;
    double largest = 0;
    for (int i = 0; i < kMostValves; ++i) {
      const bool held = (best.x[i] <= problem.lower[i] && d.g[i] > 0) ||
                        (best.x[i] >= problem.upper[i] && d.g[i] < 0);
      if (held) {
        d.g[i] = 0;
        for (ValveMatrix* m : {&d.A, &whole}) {
          m->row(i).setZero();
          m->col(i).setZero();
          (*m)(i, i) = 1;
        }
      }
      largest = std::max(largest, std::abs(d.g[i]));
    }
    if (largest < kGradient) return best;
    const ValveAngles diagonal = d.A.diagonal(), whole_diagonal = whole.diagonal();
    for (int attempt = 0;; ++attempt) {
      if (attempt == 30) return best;
      whole.diagonal() = whole_diagonal + damping * diagonal;
      ValveAngles step;
      const bool newton = SolveFixed(whole, d.g, step);
      if (!newton) {
        d.A.diagonal() = (1 + damping) * diagonal;
        if (!SolveFixed(d.A, d.g, step)) return best;
      }
      const ValveAngles x = (best.x - step).cwiseMax(problem.lower).cwiseMin(problem.upper);
      const double moved = (x - best.x).cwiseAbs().maxCoeff();
      if (!(moved > kStep)) return best;
      const double cost = problem.Cost(x);
      if (cost < best.cost) {
        // Along a Newton step that is inside the ranges the cost falls by g step where it is a
        // parabola; a third derivative that takes the part p from that leaves a next step of 3/2 p
        // along it.
        const double fall = d.g.dot(step), gained = best.cost - cost;
        const bool inside = newton && x == best.x - step;
        best.x = x;
        best.cost = cost;
        best.squared_tip_errors = problem.squared_tip_errors();
        if (inside && 1.5 * std::abs(gained / fall - 1) * moved < kLeft) return best;
        damping = std::max(damping / 10, 1e-12);
        growth = 2;
        break;
      }
      damping = std::max(damping, 1e-12) * growth;
      growth *= 2;
    }
  }
  return best;
}

// A finger at the end of a joint's range may be better bent at its other joint: the solution of the
// whole ranges with the bend of one finger moved there, if it is better by more than round-off.
void BendElsewhere(const RobotHand& robot, MappingProblem& free, int max_iterations,
                   MappingSolution& solution) {
  constexpr double kBetter = 1 - 1e-4;  // of the cost
  constexpr double kAtEnd = 1e-6;       // rad
  const MappingSolution before = solution;
  for (const RobotHand::Finger& finger : robot.fingers) {
    const int v0 = robot.valve_of[finger.j0], v1 = robot.valve_of[finger.j1];
    if (v0 == v1) continue;
    const double bend0 = before.x[v0] - free.lower[v0], bend1 = before.x[v1] - free.lower[v1];
    if (bend0 > kAtEnd && bend1 > kAtEnd) continue;
    // The tip comes about as near to the knuckle by twice the angle at the middle joint; well off
    // the end of the range, where the slope may lead back.
    ValveAngles start = before.x;
    start[v0] = free.lower[v0] + 0.5 * bend1;
    start[v1] = std::min(free.lower[v1] + 2 * bend0 + 0.3, free.upper[v1]);
    const MappingSolution other = Minimize(free, start, max_iterations);
    if (other.cost < kBetter * solution.cost) solution = other;
  }
}

MappingResult MapFrame(const RobotHand& robot, const MappingTarget& target,
                       const Eigen::VectorXd& previous, const MappingOptions& options,
                       FastHand& hand) {
  MappingProblem problem(robot, target, previous, options, hand);
  MappingSolution solution = Minimize(problem, problem.Start(), options.max_iterations);
  // The position term has two basins per finger (bent at the knuckle or at the middle joint): a
  // cold start looks into the other ones too.
  for (int f = 0; f < kNumFingers && !problem.warm(); ++f) {
    const int v0 = robot.valve_of[robot.fingers[f].j0], v1 = robot.valve_of[robot.fingers[f].j1];
    for (const Eigen::Vector2d& part : kOtherStarts) {
      ValveAngles start = solution.x;
      start[v0] = problem.lower[v0] + part[0] * (problem.upper[v0] - problem.lower[v0]);
      start[v1] = problem.lower[v1] + part[1] * (problem.upper[v1] - problem.lower[v1]);
      const MappingSolution other = Minimize(problem, start, options.max_iterations);
      if (other.cost < solution.cost) solution = other;
    }
  }
  return ResultOf(problem, solution);
}

// From the anchor to one end (`way` 1: the last frame, -1: the first). Every few frames the other
// bends of fingers at the end of a range are looked into; where one has become better the hand goes
// there, at most max_step a frame.
void MapOnwards(const RobotHand& robot, const std::vector<MappingTarget>& targets, int anchor,
                int way, const MappingOptions& options, FastHand& hand,
                std::vector<MappingResult>& results) {
  constexpr int kLookEvery = 4;  // frames
  MappingOptions unbounded = options;
  unbounded.max_step = 0;
  std::optional<ValveAngles> heading;
  const int n = static_cast<int>(targets.size());
  for (int k = anchor + way; k >= 0 && k < n; k += way) {
    const Eigen::VectorXd& previous = results[k - way].q;
    MappingProblem problem(robot, targets[k], previous, options, hand);
    MappingSolution solution = Minimize(problem, problem.Start(), options.max_iterations);
    if (heading || (k - anchor) % kLookEvery == 0) {
      MappingProblem free(robot, targets[k], previous, unbounded, hand);
      MappingSolution other = heading ? Minimize(free, *heading, options.max_iterations) : solution;
      if (!heading) BendElsewhere(robot, free, options.max_iterations, other);
      heading.reset();
      if (other.cost < solution.cost) {
        const ValveAngles x = other.x.cwiseMax(problem.lower).cwiseMin(problem.upper);
        if (x != other.x) heading = other.x;
        solution.x = x;
        solution.cost = problem.Cost(x);
        solution.squared_tip_errors = problem.squared_tip_errors();
      }
    }
    results[k] = ResultOf(problem, solution);
  }
}

}  // namespace

MappingResult MapHand(const RobotHand& robot, const MappingTarget& target,
                      const Eigen::VectorXd& previous, const MappingOptions& options) {
  FastHand hand(robot);
  return MapFrame(robot, target, previous, options, hand);
}

std::vector<MappingResult> MapHandAlong(const RobotHand& robot,
                                        const std::vector<MappingTarget>& targets, int anchor,
                                        const MappingOptions& options) {
  const int n = static_cast<int>(targets.size());
  std::vector<MappingResult> results(targets.size());
  if (n == 0) return results;
  FastHand hand(robot);
  anchor = std::clamp(anchor, 0, n - 1);
  results[anchor] = MapFrame(robot, targets[anchor], {}, options, hand);
  for (const int way : {-1, 1}) MapOnwards(robot, targets, anchor, way, options, hand, results);
  return results;
}

}  // namespace springgrasp
