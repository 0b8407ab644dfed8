// The human hand's inverse kinematics and the mapping to the robot's fingers (Eq. (14)-(16)) along
// generated grasps of all four types.
//   mapping_statistics [TRAJECTORIES] [EVERY] [FIRST]   (1000, 10, 0: NLopt is asked every tenth
//                                                        frame; FIRST: the number of the first one)
//   mapping_statistics trace OUT.csv            joint angles through one grasp of each type
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <string>

#include "base/files.h"
#include "grasp_cases.h"
#include "statistics_main.h"

namespace springgrasp {
namespace {

constexpr std::uint64_t kSeed = 2001;
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kJump = 3 / kDegrees;  // rad between samples
constexpr double kTipJump = 0.004;      // m between samples: demanded
constexpr double kReachable = 0.001;    // m, of the distance-only optimum
constexpr double kLambdas[] = {1, 10, 100, 1000};
constexpr int kRestarts = 20;

struct Spread {
  std::vector<double> values;
  void Add(double value) { values.push_back(value); }
  double At(double part) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
  }
};

struct Tally {
  long frames = 0, outside = 0, asked = 0, worse = 0, jumps = 0, limited = 0, demanded = 0;
  double largest_jump = 0, largest_excess = 0;
};

struct LambdaTally {
  Spread error, likeness, reachable_error;
};

struct HumanTally {
  Spread error;
  long frames = 0, outside = 0;
  double step = 0, bend = 0;
};

bool Within(const KinematicTree& tree, const Eigen::VectorXd& q) {
  return (q.array() >= tree.lower.array()).all() && (q.array() <= tree.upper.array()).all();
}

double TipStep(const MappingTarget& a, const MappingTarget& b) {
  double step = 0;
  for (int f = 0; f < kNumFingers; ++f) step = std::max(step, (a.p_HF[f] - b.p_HF[f]).norm());
  return step;
}

void Count(const GraspCase& c, int every, Tally& tally) {
  const RobotHand& robot = c.body->hand;
  const std::vector<MappingTarget> targets = MappingTargets(c.human, robot, c.request);
  MappingOptions options;
  options.max_step = kJump;
  const std::vector<MappingResult> mapped = MapHandAlong(robot, targets, Anchor(c), options);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    ++tally.frames;
    if (!Within(robot.tree, mapped[k].q)) ++tally.outside;
    if (k > 0) {
      const double step = (mapped[k].q - mapped[k - 1].q).cwiseAbs().maxCoeff();
      if (TipStep(targets[k], targets[k - 1]) > kTipJump) {
        ++tally.demanded;
      } else {
        if (step > kJump * (1 + 1e-9)) ++tally.jumps;
        if (step > kJump * (1 - 1e-6)) ++tally.limited;
        tally.largest_jump = std::max(tally.largest_jump, step);
      }
    }
    if (k % static_cast<std::size_t>(every) != 0) continue;
    ++tally.asked;
    const double best = MapHandByNlopt(robot, targets[k], kRestarts).cost;
    const double excess = mapped[k].cost - best;
    if (excess > 1e-9 + 1e-6 * best) ++tally.worse;
    tally.largest_excess = std::max(tally.largest_excess, excess / best);
  }
}

// The involved fingers' position weight constant; the distance-only optimum says who can be there.
void CountLambdas(const GraspCase& c, int every, std::map<double, LambdaTally>& of_type,
                  std::map<double, LambdaTally>& of_all) {
  const RobotHand& robot = c.body->hand;
  const std::vector<MappingTarget> planned = MappingTargets(c.human, robot, c.request);
  std::map<double, std::vector<MappingResult>> mapped;
  for (const double lambda : {1.0, 10.0, 100.0, 1000.0, 1e9}) {
    std::vector<MappingTarget> targets = planned;
    for (MappingTarget& target : targets) {
      for (int f = 0; f < kNumFingers; ++f) {
        if (c.request.involved[f]) target.lambda[f] = lambda;
      }
    }
    mapped[lambda] = MapHandAlong(robot, targets, Anchor(c));
  }
  for (std::size_t k = 0; k < planned.size(); k += static_cast<std::size_t>(every)) {
    for (int f = 0; f < kNumFingers; ++f) {
      if (!c.request.involved[f]) continue;
      const bool reachable = mapped[1e9][k].tip_error[f] <= kReachable;
      const RobotHand::Finger& finger = robot.fingers[f];
      for (const double lambda : kLambdas) {
        const MappingResult& result = mapped[lambda][k];
        const Eigen::Vector2d off(result.q[finger.j0] - planned[k].sigma[f][0],
                                  result.q[finger.j1] - planned[k].sigma[f][1]);
        for (LambdaTally* tally : {&of_type[lambda], &of_all[lambda]}) {
          tally->error.Add(1e3 * result.tip_error[f]);
          if (reachable) tally->reachable_error.Add(1e3 * result.tip_error[f]);
          tally->likeness.Add(kDegrees * std::sqrt(off.squaredNorm() / 2));
        }
      }
    }
  }
}

void CountHuman(const GraspCase& c, HumanTally& tally) {
  std::vector<Pose> X_HB;
  for (std::size_t k = 0; k < c.q_human.size(); ++k) {
    ++tally.frames;
    if (!Within(c.human.tree, c.q_human[k])) ++tally.outside;
    ForwardKinematics(c.human.tree, c.q_human[k], X_HB);
    for (int f = 0; f < kNumFingers; ++f) {
      tally.error.Add(1e3 * (FramePose(c.human.tree, X_HB, c.human.tip[f]).translation() -
                             c.motion.samples[k].p_HF[f])
                                .norm());
    }
    if (k == 0) continue;
    tally.step = std::max(tally.step, (c.q_human[k] - c.q_human[k - 1]).cwiseAbs().maxCoeff());
    if (k < 2) continue;
    tally.bend = std::max(
        tally.bend, (c.q_human[k] - 2 * c.q_human[k - 1] + c.q_human[k - 2]).cwiseAbs().maxCoeff());
  }
}

void Print(const std::string& name, const Tally& t) {
  fmt::print(
      "{:<8} {:>8} {:>8} {:>8} {:>7.2f} {:>9.1e} {:>7} {:>8.2f} {:>8} {:>9}\n", name, t.frames,
      t.outside, t.asked,
      100.0 * static_cast<double>(t.asked - t.worse) / static_cast<double>(std::max(1L, t.asked)),
      t.largest_excess, t.jumps, kDegrees * t.largest_jump, t.limited, t.demanded);
}

// Wanted and mapped joint angles (degrees) and the tips' distance from where they are wanted (mm).
void Trace(const std::string& path) {
  const GraspBodies bodies = MakeGraspBodies();
  const std::vector<Grasp> library = ReadLibrary();
  std::string csv = "type,t_of_T";
  for (const std::string_view finger : kFingerNames) {
    for (const char* what : {"j0_wanted", "j1_wanted", "j0", "j1", "error_mm", "lambda"}) {
      csv += fmt::format(",{}_{}", finger, what);
    }
  }
  csv += ",palm\n";
  for (std::uint64_t n = 0; n < library.size(); ++n) {
    const GraspCase c = MakeGraspCase(bodies, library, kSeed, n);
    const RobotHand& robot = c.body->hand;
    const std::vector<MappingTarget> targets = MappingTargets(c.human, robot, c.request);
    MappingOptions options;
    options.max_step = kJump;
    const std::vector<MappingResult> mapped = MapHandAlong(robot, targets, Anchor(c), options);
    for (std::size_t k = 0; k < targets.size(); k += 2) {
      csv += fmt::format("{},{:.4f}", c.type, c.request.dt * static_cast<double>(k) / c.request.T);
      for (int f = 0; f < kNumFingers; ++f) {
        const RobotHand::Finger& finger = robot.fingers[f];
        const Eigen::VectorXd& q = mapped[k].q;
        csv += fmt::format(",{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}",
                           kDegrees * targets[k].sigma[f][0], kDegrees * targets[k].sigma[f][1],
                           kDegrees * q[finger.j0], kDegrees * q[finger.j1],
                           1e3 * mapped[k].tip_error[f], targets[k].lambda[f]);
      }
      csv += fmt::format(",{:.3f}\n", kDegrees * mapped[k].q[robot.palm]);
    }
  }
  WriteFileAtomically(path, csv);
}

int Main(int argc, char** argv) {
  if (argc == 3 && std::string(argv[1]) == "trace") {
    Trace(argv[2]);
    return 0;
  }
  const int trajectories = argc > 1 ? std::atoi(argv[1]) : 1000;
  const int every = argc > 2 ? std::atoi(argv[2]) : 10;
  const int first = argc > 3 ? std::atoi(argv[3]) : 0;
  const GraspBodies bodies = MakeGraspBodies();
  const std::vector<Grasp> library = ReadLibrary();
  std::map<std::string, Tally> tallies;
  std::map<std::string, HumanTally> human;
  std::map<std::string, std::map<double, LambdaTally>> lambdas;
  for (int n = first; n < first + trajectories; ++n) {
    const GraspCase c = MakeGraspCase(bodies, library, kSeed, static_cast<std::uint64_t>(n));
    Count(c, every, tallies[c.type]);
    CountLambdas(c, every, lambdas[c.type], lambdas["all"]);
    for (const std::string& name : {c.type, std::string("all")}) CountHuman(c, human[name]);
  }
  fmt::print(
      "human hand: distance of its tips from those wanted, mm; largest joint step and bend "
      "(second difference) between samples, degrees\n");
  fmt::print("grasp      frames  outside   median    95 %  largest    step    bend\n");
  for (auto& [name, t] : human) {
    fmt::print("{:<8} {:>8} {:>8} {:>8.3f} {:>7.3f} {:>8.3f} {:>7.2f} {:>7.3f}\n", name, t.frames,
               t.outside, t.error.At(0.5), t.error.At(0.95), t.error.At(1), kDegrees * t.step,
               kDegrees * t.bend);
  }
  fmt::print(
      "\nmapping: frames outside the ranges, asked of NLopt ({} starts), as good (%), "
      "largest excess of S' (relative); steps over 3 degrees and the largest one, degrees; steps "
      "at the "
      "limit of 3 degrees; "
      "steps where the wanted tip jumps over {:.0f} mm\n",
      kRestarts, 1e3 * kTipJump);
  fmt::print(
      "grasp      frames  outside    asked    good    excess   jumps  largest  limited  "
      "demanded\n");
  Tally all;
  for (const auto& [name, t] : tallies) {
    Print(name, t);
    all.frames += t.frames;
    all.outside += t.outside;
    all.asked += t.asked;
    all.worse += t.worse;
    all.jumps += t.jumps;
    all.limited += t.limited;
    all.demanded += t.demanded;
    all.largest_jump = std::max(all.largest_jump, t.largest_jump);
    all.largest_excess = std::max(all.largest_excess, t.largest_excess);
  }
  Print("all", all);
  fmt::print(
      "\ninvolved fingers at a constant lambda: tip error, mm; joint angles against the "
      "human's (RMS of both joints), degrees; tip error where the tip can be reached within "
      "{:.0f} mm, mm\n",
      1e3 * kReachable);
  fmt::print("grasp    lambda   median    95 %   joints    95 %   reachable %  median    95 %\n");
  for (auto& [name, of] : lambdas) {
    for (auto& [lambda, t] : of) {
      fmt::print("{:<8} {:>6} {:>8.2f} {:>7.2f} {:>8.2f} {:>7.2f} {:>13.1f} {:>7.2f} {:>7.2f}\n",
                 name, lambda, t.error.At(0.5), t.error.At(0.95), t.likeness.At(0.5),
                 t.likeness.At(0.95),
                 100.0 * static_cast<double>(t.reachable_error.values.size()) /
                     static_cast<double>(t.error.values.size()),
                 t.reachable_error.At(0.5), t.reachable_error.At(0.95));
    }
  }
  return 0;
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return StatisticsMain(argc, argv, springgrasp::Main); }
