#include "kinematics/hand_mapping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlopt.hpp>
#include <numbers>
#include <optional>

#include "base/error.h"
#include "base/random.h"
#include "kinematics/fast_hand.h"

namespace springgrasp {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kJointScale = 1 / (kPi * std::numbers::sqrt2);  // n = 2 joints per finger

const std::array<Eigen::Vector2d, 4> kOtherStarts = {
    Eigen::Vector2d(0.1, 0.9), Eigen::Vector2d(0.9, 0.1), Eigen::Vector2d(0.3, 0.3),
    Eigen::Vector2d(0.8, 0.8)};  // of the ranges of j0, j1

// The sum of squares of MappingOptions' table over one angle per valve, with scratch space.
class MappingProblem {
 public:
  MappingProblem(const RobotHand& robot, const MappingTarget& target,
                 const Eigen::VectorXd& previous, const MappingOptions& options, FastHand& hand)
      : robot_(robot),
        target_(target),
        previous_(previous),
        options_(options),
        q_(robot.open),
        hand_(hand) {
    lower.setZero();
    upper.setZero();
    for (int v = 0; v < num_valves(); ++v) {
      lower[v] = -std::numeric_limits<double>::infinity();
      upper[v] = -lower[v];
      for (const int j : robot.valves[v]) {
        lower[v] = std::max(lower[v], robot.tree.lower[j]);
        upper[v] = std::min(upper[v], robot.tree.upper[j]);
      }
    }
    warm_ = previous.size() == robot.tree.num_joints();
    if (warm_ && options.max_step > 0) {
      const ValveAngles from = Valves(previous).cwiseMax(lower).cwiseMin(upper);
      lower = lower.cwiseMax((from.array() - options.max_step).matrix());
      upper = upper.cwiseMin((from.array() + options.max_step).matrix());
    }
  }

  int num_valves() const { return static_cast<int>(robot_.valves.size()); }
  bool warm() const { return warm_; }

  // Joints of one chamber feel equal torque against equal springs: one angle.
  const Eigen::VectorXd& Joints(const ValveAngles& x) {
    for (int v = 0; v < num_valves(); ++v) {
      for (const int j : robot_.valves[v]) q_[j] = x[v];
    }
    return q_;
  }

  // The valves' angles nearest to joint angles: the mean of their joints.
  ValveAngles Valves(const Eigen::VectorXd& q) const {
    ValveAngles x = ValveAngles::Zero();
    for (int v = 0; v < num_valves(); ++v) {
      double sum = 0;
      for (const int j : robot_.valves[v]) sum += q[j];
      x[v] = sum / static_cast<double>(robot_.valves[v].size());
    }
    return x;
  }

  // Where the mapping starts: from the previous frame, or from the human's angles.
  ValveAngles Start() const {
    if (warm_) return Valves(previous_).cwiseMax(lower).cwiseMin(upper);
    Eigen::VectorXd q = robot_.open;
    for (int f = 0; f < kNumFingers; ++f) {
      q[robot_.fingers[f].j0] = target_.sigma[f][0];
      q[robot_.fingers[f].j1] = target_.sigma[f][1];
    }
    if (robot_.palm >= 0) q[robot_.palm] = options_.palm_wanted;
    if (robot_.opposition >= 0) q[robot_.opposition] = target_.opposition;
    return Valves(q).cwiseMax(lower).cwiseMin(upper);
  }

  // S' of Eq. (15) with our own rows: the sum of squares |r|^2; A = J'J and g = J'r where wanted,
  // and the rest of the second derivatives, B = sum of r times its own.
  struct Curvature {
    ValveMatrix A, B;
  };
  double Evaluate(const ValveAngles& x, Curvature* curvature, ValveAngles* g) {
    Joints(x);
    hand_.Move(x);
    ValveMatrix* A = nullptr;
    if (curvature != nullptr) {
      A = &curvature->A;
      A->setZero();
      curvature->B.setZero();
      for (int v = num_valves(); v < kMostValves; ++v) (*A)(v, v) = 1;
    }
    if (g != nullptr) g->setZero();
    double cost = 0;
    const auto add = [&](double weight, int joint, double wanted) {
      const int v = robot_.valve_of[joint];
      const double r = weight * (q_[joint] - wanted);
      cost += r * r;
      if (A != nullptr) (*A)(v, v) += weight * weight;
      if (g != nullptr) (*g)[v] += weight * r;
    };
    for (int f = 0; f < kNumFingers; ++f) {
      const RobotHand::Finger& finger = robot_.fingers[f];
      add(kJointScale, finger.j0, target_.sigma[f][0]);
      add(kJointScale, finger.j1, target_.sigma[f][1]);
      AddTip(f, curvature, g, cost);
    }
    if (robot_.palm >= 0) add(options_.palm_weight / kPi, robot_.palm, options_.palm_wanted);
    if (robot_.opposition >= 0) add(kJointScale, robot_.opposition, target_.opposition);
    if (warm_ && options_.smoothness > 0) {
      for (int j = 0; j < robot_.tree.num_joints(); ++j) {
        add(options_.smoothness / kPi, j, previous_[j]);
      }
    }
    return cost;
  }

  // Of the tips at the last evaluation, m^2.
  const PerFinger<double>& squared_tip_errors() const { return squared_tip_errors_; }

  ValveAngles lower, upper;  // of the valves' angles, rad

 private:
  Eigen::Vector3d TipError(int f) const {
    const KinematicTree::Frame& frame = robot_.tree.frames[robot_.fingers[f].tip];
    const FastHand::Body& body = hand_.body(frame.node);
    return body.R_HB * frame.X_BF.translation() + body.p_HB - target_.p_HF[f];
  }

  // The position term of a finger, by the joints between its tip and H.
  void AddTip(int f, Curvature* curvature, ValveAngles* g, double& cost) {
    constexpr int kMostJoints = 8;
    const RobotHand::Finger& finger = robot_.fingers[f];
    const Eigen::Vector3d e = TipError(f);
    const double weight = target_.lambda[f] / (3 * 4 * finger.length * finger.length);
    squared_tip_errors_[f] = e.squaredNorm();
    cost += weight * squared_tip_errors_[f];
    if (g == nullptr) return;
    const Eigen::Vector3d p_HF = e + target_.p_HF[f];
    std::array<Eigen::Vector3d, kMostJoints> axis, column;
    std::array<int, kMostJoints> valve;
    int count = 0;
    for (int b = robot_.tree.frames[finger.tip].node; b >= 0; b = hand_.body(b).parent) {
      const FastHand::Body& body = hand_.body(b);
      if (body.valve < 0 || count == kMostJoints) continue;
      axis[count] = body.R_HB * body.axis;
      column[count] = axis[count].cross(p_HF - body.p_HB);
      valve[count++] = body.valve;
    }
    for (int i = 0; i < count; ++i) {
      (*g)[valve[i]] += weight * column[i].dot(e);
      if (curvature == nullptr) continue;
      // d2p / dq_i dq_j: what the joint nearer to the tip does, turned by the other.
      for (int j = 0; j <= i; ++j) {
        const double a = weight * column[i].dot(column[j]);
        const double b = weight * e.dot(axis[i].cross(column[j]));
        curvature->A(valve[i], valve[j]) += a;
        curvature->B(valve[i], valve[j]) += b;
        if (j == i) continue;
        curvature->A(valve[j], valve[i]) += a;
        curvature->B(valve[j], valve[i]) += b;
      }
    }
  }

  const RobotHand& robot_;
  const MappingTarget& target_;
  const Eigen::VectorXd& previous_;
  const MappingOptions& options_;
  bool warm_ = false;
  Eigen::VectorXd q_;
  FastHand& hand_;
  PerFinger<double> squared_tip_errors_ = {};
};

struct MappingSolution {
  ValveAngles x;
  double cost = 0;
  PerFinger<double> squared_tip_errors = {};
};

MappingResult ResultOf(MappingProblem& problem, const MappingSolution& solution) {
  MappingResult result;
  result.q = problem.Joints(solution.x);
  result.cost = solution.cost;
  for (int f = 0; f < kNumFingers; ++f) {
    result.tip_error[f] = std::sqrt(solution.squared_tip_errors[f]);
  }
  return result;
}

// Solution of A y = b by Cholesky's method, its loops of fixed length so that they are unrolled;
// only A's lower part is read. False: A is not positive definite.
bool SolveFixed(const ValveMatrix& A, const ValveAngles& b, ValveAngles& y) {
  double L[kMostValves][kMostValves], inverse[kMostValves];
  for (int i = 0; i < kMostValves; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = A(i, j);
      for (int k = 0; k < j; ++k) sum -= L[i][k] * L[j][k];
      if (j < i) {
        L[i][j] = sum * inverse[j];
      } else {
        if (!(sum > 0)) return false;
        inverse[i] = 1 / std::sqrt(sum);
      }
    }
  }
  for (int i = 0; i < kMostValves; ++i) {
    double sum = b[i];
    for (int k = 0; k < i; ++k) sum -= L[i][k] * y[k];
    y[i] = sum * inverse[i];
  }
  for (int i = kMostValves - 1; i >= 0; --i) {
    double sum = y[i];
    for (int k = i + 1; k < kMostValves; ++k) sum -= L[k][i] * y[k];
    y[i] = sum * inverse[i];
  }
  return true;
}

// Projected Levenberg-Marquardt as in levenberg_marquardt.h, on the normal equations alone, with
// the whole second derivatives where these are positive definite: where a tip is out of reach,
// Gauss-Newton takes tens of steps.
MappingSolution Minimize(MappingProblem& problem, const ValveAngles& start, int max_iterations) {
  constexpr double kStep = 3e-5;      // rad, where it ends
  constexpr double kGradient = 1e-9;  // of the cost, per rad
  MappingSolution best;
  best.x = start;
  MappingProblem::Curvature now, trial;
  ValveMatrix gauss, whole;
  ValveAngles g, g_trial;
  best.cost = problem.Evaluate(best.x, &now, &g);
  best.squared_tip_errors = problem.squared_tip_errors();
  double damping = 1e-4, growth = 2;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    double largest = 0;
    gauss = now.A;
    whole = now.A + now.B;
    ValveAngles slope = g;
    for (int i = 0; i < kMostValves; ++i) {
      const bool held = (best.x[i] <= problem.lower[i] && slope[i] > 0) ||
                        (best.x[i] >= problem.upper[i] && slope[i] < 0);
      if (held) {
        slope[i] = 0;
        for (ValveMatrix* m : {&gauss, &whole}) {
          m->row(i).setZero();
          m->col(i).setZero();
          (*m)(i, i) = 1;
        }
      }
      largest = std::max(largest, std::abs(slope[i]));
    }
    if (largest < kGradient) return best;
    const ValveAngles diagonal = gauss.diagonal(), whole_diagonal = whole.diagonal();
    for (int attempt = 0;; ++attempt) {
      if (attempt == 30) return best;
      whole.diagonal() = whole_diagonal + damping * diagonal;
      ValveAngles step;
      if (!SolveFixed(whole, slope, step)) {
        gauss.diagonal() = (1 + damping) * diagonal;
        if (!SolveFixed(gauss, slope, step)) return best;
      }
      const ValveAngles x = (best.x - step).cwiseMax(problem.lower).cwiseMin(problem.upper);
      if (!((x - best.x).cwiseAbs().maxCoeff() > kStep)) return best;
      const double cost = problem.Evaluate(x, &trial, &g_trial);
      if (cost < best.cost) {
        best.x = x;
        best.cost = cost;
        best.squared_tip_errors = problem.squared_tip_errors();
        now = trial;
        g = g_trial;
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
    const double bend0 = before.x[v0] - free.lower[v0], bend1 = before.x[v1] - free.lower[v1];
    if (bend0 > kAtEnd && bend1 > kAtEnd) continue;
    // The tip comes about as near to the knuckle by twice the angle at the middle joint.
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

// From the anchor to the end. Every few frames the other bends of fingers at the end of a range are
// looked into; where one has become better the hand goes there, at most max_step a frame.
void MapOnwards(const RobotHand& robot, const std::vector<MappingTarget>& targets, int anchor,
                const MappingOptions& options, FastHand& hand,
                std::vector<MappingResult>& results) {
  constexpr int kLookEvery = 4;  // frames
  MappingOptions unbounded = options;
  unbounded.max_step = 0;
  std::optional<ValveAngles> heading;
  for (int k = anchor + 1; k < static_cast<int>(targets.size()); ++k) {
    MappingProblem problem(robot, targets[k], results[k - 1].q, options, hand);
    MappingSolution solution = Minimize(problem, problem.Start(), options.max_iterations);
    if (heading || (k - anchor) % kLookEvery == 0) {
      MappingProblem free(robot, targets[k], results[k - 1].q, unbounded, hand);
      MappingSolution other = heading ? Minimize(free, *heading, options.max_iterations) : solution;
      if (!heading) BendElsewhere(robot, free, options.max_iterations, other);
      heading.reset();
      if (other.cost < solution.cost) {
        const ValveAngles x = other.x.cwiseMax(problem.lower).cwiseMin(problem.upper);
        if (x != other.x) heading = other.x;
        solution.x = x;
        solution.cost = problem.Evaluate(x, nullptr, nullptr);
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
  for (int k = anchor - 1; k >= 0; --k) {
    results[k] = MapFrame(robot, targets[k], results[k + 1].q, options, hand);
  }
  MapOnwards(robot, targets, anchor, options, hand, results);
  return results;
}

MappingResult MapHandByNlopt(const RobotHand& robot, const MappingTarget& target, int starts,
                             const Eigen::VectorXd& previous, const MappingOptions& options) {
  FastHand hand(robot);
  MappingProblem problem(robot, target, previous, options, hand);
  const int n = problem.num_valves();
  nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(n));
  const nlopt::vfunc objective = [](const std::vector<double>& x, std::vector<double>& gradient,
                                    void* context) {
    ValveAngles angles = ValveAngles::Zero();
    std::copy(x.begin(), x.end(), angles.data());
    ValveAngles g;
    const double cost = static_cast<MappingProblem*>(context)->Evaluate(
        angles, nullptr, gradient.empty() ? nullptr : &g);
    for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] = 2 * g[i];
    return cost;
  };
  solver.set_min_objective(objective, &problem);
  const auto as_vector = [n](const ValveAngles& v) {
    return std::vector<double>(v.data(), v.data() + n);
  };
  solver.set_lower_bounds(as_vector(problem.lower));
  solver.set_upper_bounds(as_vector(problem.upper));
  solver.set_xtol_abs(3e-5);
  solver.set_ftol_rel(1e-12);
  solver.set_maxeval(500);
  RandomEngine engine = MakeStream(0, 0, "mapping yardstick");
  MappingSolution best;
  best.cost = std::numeric_limits<double>::infinity();
  for (int s = 0; s < starts; ++s) {
    std::vector<double> x = as_vector(problem.Start());
    for (int v = 0; v < n && s > 0; ++v) {
      x[v] = Uniform(engine, problem.lower[v], problem.upper[v]);
    }
    double found = 0;
    try {
      solver.optimize(x, found);
    } catch (const std::runtime_error&) {
      // Round-off at the optimum: x is still the best point so far.
    }
    ValveAngles angles = ValveAngles::Zero();
    std::copy(x.begin(), x.end(), angles.data());
    const double cost = problem.Evaluate(angles, nullptr, nullptr);
    if (cost < best.cost) best = {angles, cost, problem.squared_tip_errors()};
  }
  return ResultOf(problem, best);
}

}  // namespace springgrasp
