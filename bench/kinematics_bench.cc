// The mapping against NLopt's SLSQP on the same frames, the arm against Orocos KDL's Newton-Raphson
// on the same poses, each timed by turns.
#include <benchmark/benchmark.h>

#include <ctime>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>

#include "base/random.h"
#include "experiment/grasp_requests.h"
#include "grasp_cases.h"
#include "kinematics/arm_swivel.h"
#include "kinematics/hand_ik.h"

namespace springgrasp {
namespace {

constexpr std::uint64_t kSeed = 1001;

// Of this thread's processor: other processes on the machine do not count.
double Now() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

const GraspBodies& Bodies() {
  static const GraspBodies bodies = MakeGraspBodies();
  return bodies;
}

struct Motion {
  const RobotHand* robot = nullptr;
  std::vector<MappingTarget> targets;
  int anchor = 0;
};

// Two grasps of each type.
const std::vector<Motion>& Motions() {
  static const std::vector<Motion> motions = [] {
    std::vector<Motion> result;
    const std::vector<Grasp> library = ReadLibrary();
    for (std::uint64_t n = 0; n < 8; ++n) {
      const GraspCase c = MakeGraspCase(Bodies(), library, kSeed, n);
      result.push_back(
          {&c.body->hand, MappingTargets(c.human, c.body->hand, c.request), Anchor(c)});
    }
    return result;
  }();
  return motions;
}

// Five fingers of a frame along whole motions, each started from its neighbour's solution, by both
// solvers alike.
void MappingAgainstSlsqp(benchmark::State& state) {
  double ours = 0, slsqp = 0, worse = 0, slsqp_worse = 0, frames = 0;
  Motions();
  for (auto _ : state) {
    for (const Motion& motion : Motions()) {
      const double t0 = Now();
      const std::vector<MappingResult> mapped =
          MapHandAlong(*motion.robot, motion.targets, motion.anchor);
      ours += Now() - t0;
      frames += static_cast<double>(mapped.size());
      for (int k = 0; k < static_cast<int>(mapped.size()); ++k) {
        const int from = k < motion.anchor ? k + 1 : std::max(0, k - 1);
        const Eigen::VectorXd previous = k == motion.anchor ? Eigen::VectorXd() : mapped[from].q;
        const double t1 = Now();
        const double b = MapHandByNlopt(*motion.robot, motion.targets[k], 1, previous).cost;
        slsqp += Now() - t1;
        const double a = mapped[k].cost;
        worse += a > b + 1e-9 + 1e-6 * b;
        slsqp_worse += b > a + 1e-9 + 1e-6 * a;
      }
    }
  }
  state.counters["ours_us"] = 1e6 * ours / frames;
  state.counters["slsqp_us"] = 1e6 * slsqp / frames;
  state.counters["ratio"] = slsqp / ours;
  state.counters["worse_%"] = 100 * worse / frames;
  state.counters["slsqp_worse_%"] = 100 * slsqp_worse / frames;
}
BENCHMARK(MappingAgainstSlsqp)->Unit(benchmark::kMillisecond);

void HumanHandFrame(benchmark::State& state) {
  const GraspCase c = MakeGraspCase(Bodies(), ReadLibrary(), kSeed, 0);
  const std::vector<KnownTips> tips = TipsOf(c.motion);
  for (auto _ : state) benchmark::DoNotOptimize(SolveHandMotion(c.human, tips));
  state.counters["frame_ms"] = benchmark::Counter(
      1e-3 * static_cast<double>(tips.size()),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(HumanHandFrame)->Unit(benchmark::kMillisecond);

KDL::Vector KdlVector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame KdlFrame(const Pose& X) {
  const Eigen::Matrix3d R = X.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          KdlVector(X.translation())};
}

// The same arm: hinges about the axes that it has in the world at q = 0.
KDL::Chain KdlArm(const Arm& arm, const ArmGeometry& g) {
  const Eigen::Vector3d elbow = g.p_WS + g.p_SE, wrist = elbow + g.p_EC;
  const Eigen::Vector3d points[7] = {g.p_WS, g.p_WS, g.p_WS, elbow, wrist, wrist, wrist};
  const Eigen::Vector3d axes[7] = {g.shoulder.axis[0], g.shoulder.axis[1], g.shoulder.axis[2],
                                   g.elbow_axis,       g.wrist.axis[0],    g.wrist.axis[1],
                                   g.wrist.axis[2]};
  const Pose X_WH = HandPose(arm, Eigen::VectorXd::Zero(7));
  KDL::Chain chain;
  for (int i = 0; i < 7; ++i) {
    chain.addSegment(
        KDL::Segment(KDL::Joint(KdlVector(points[i]), KdlVector(axes[i]), KDL::Joint::RotAxis),
                     i == 6 ? KdlFrame(X_WH) : KDL::Frame::Identity()));
  }
  return chain;
}

// 1000 poses that random postures have. KDL starts in mid range, at most 100 iterations, and once
// more with up to `restarts` random starts.
void ArmAgainstKdl(benchmark::State& state) {
  const int restarts = static_cast<int>(state.range(0));
  constexpr int kPoses = 1000;
  const Arm& arm = Bodies().documented.arm;
  const ArmGeometry geometry = *GeometryOf(arm);
  KDL::Chain chain = KdlArm(arm, geometry);
  KDL::JntArray lower(7), upper(7), start(7), q(7);
  lower.data = geometry.lower;
  upper.data = geometry.upper;
  KDL::ChainFkSolverPos_recursive forward(chain);
  KDL::ChainIkSolverVel_pinv velocity(chain);
  KDL::ChainIkSolverPos_NR_JL newton(chain, lower, upper, forward, velocity, 100, 1e-4);
  RandomEngine engine = MakeStream(kSeed, 0, "arm bench");
  std::vector<Pose> poses;
  for (int n = 0; n < kPoses; ++n) {
    Eigen::VectorXd random(7);
    for (int i = 0; i < 7; ++i) random[i] = Uniform(engine, geometry.lower[i], geometry.upper[i]);
    poses.push_back(HandPose(arm, random));
    q.data = random;
    KDL::Frame made;
    forward.JntToCart(q, made);
    if (!KDL::Equal(made, KdlFrame(poses.back()), 1e-9)) {
      state.SkipWithError("the two arms differ");
      return;
    }
  }
  ArmIkOptions options;
  options.margin = 0;
  double ours = 0, kdl = 0, ours_solved = 0, kdl_solved = 0;
  const auto reached = [&](const Pose& X, const Eigen::VectorXd& found) {
    const Pose X_WH = HandPose(arm, found);
    return (X_WH.translation() - X.translation()).norm() < 1e-4 &&
           RotationDistance(Eigen::Quaterniond(X_WH.linear()), Eigen::Quaterniond(X.linear())) <
               1e-3;
  };
  for (auto _ : state) {
    for (const Pose& X : poses) {
      const double t0 = Now();
      const std::optional<Eigen::VectorXd> found = SolveArmIkFromAnywhere(arm, X, options);
      const double t1 = Now();
      bool solved = false;
      for (int s = 0; s <= restarts && !solved; ++s) {
        for (int i = 0; i < 7; ++i) {
          start(i) = s == 0 ? 0.5 * (lower(i) + upper(i)) : Uniform(engine, lower(i), upper(i));
        }
        solved = newton.CartToJnt(start, KdlFrame(X), q) >= 0 && reached(X, q.data);
      }
      const double t2 = Now();
      ours += t1 - t0;
      kdl += t2 - t1;
      ours_solved += found && reached(X, *found);
      kdl_solved += solved;
    }
  }
  const double n = static_cast<double>(state.iterations()) * kPoses;
  state.counters["ours_us"] = 1e6 * ours / n;
  state.counters["kdl_us"] = 1e6 * kdl / n;
  state.counters["ratio"] = kdl / ours;
  state.counters["ours_solved_%"] = 100 * ours_solved / n;
  state.counters["kdl_solved_%"] = 100 * kdl_solved / n;
}
BENCHMARK(ArmAgainstKdl)->ArgName("restarts")->Arg(0)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace springgrasp
