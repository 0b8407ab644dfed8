// The arm's inverse kinematics: random poses that some posture has, and paths through them.
//   arm_statistics [POSES] [PATHS]   (10000, 500)
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

#include "base/random.h"
#include "grasp_cases.h"
#include "kinematics/arm_ik_numeric.h"
#include "kinematics/swivel_path.h"
#include "motion/minimum_jerk.h"
#include "statistics_main.h"

namespace springgrasp {
namespace {

constexpr std::uint64_t kSeed = 1001;
constexpr double kDegrees = 180 / std::numbers::pi;
constexpr int kPathPoses = 200;
constexpr double kDt = 0.01;    // s, between the poses of a path
constexpr double kFlip = 0.35;  // rad, of any joint between two poses

Eigen::VectorXd RandomPosture(const Arm& arm, RandomEngine& engine) {
  Eigen::VectorXd q(arm.num_joints());
  for (int i = 0; i < arm.num_joints(); ++i) {
    q[i] = Uniform(engine, arm.tree.lower[arm.joints[i]], arm.tree.upper[arm.joints[i]]);
  }
  return q;
}

double PositionError(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm();
}

double RotationError(const Pose& a, const Pose& b) {
  return RotationDistance(Eigen::Quaterniond(a.linear()), Eigen::Quaterniond(b.linear()));
}

template <typename Solve>
void Poses(const Arm& arm, const std::string& name, int count, Solve&& solve) {
  RandomEngine engine = MakeStream(kSeed, 0, "arm poses");
  int solved = 0;
  double position = 0, rotation = 0, margin = 0, elbow = 0;
  for (int n = 0; n < count; ++n) {
    const Pose X_WH = HandPose(arm, RandomPosture(arm, engine));
    const std::optional<Eigen::VectorXd> q = solve(X_WH);
    if (!q) continue;
    const Pose X = HandPose(arm, *q);
    if (PositionError(X, X_WH) > 1e-4 || RotationError(X, X_WH) > 1e-3) continue;
    if (LimitMargin(arm, *q) < 0) continue;
    ++solved;
    position = std::max(position, PositionError(X, X_WH));
    rotation = std::max(rotation, RotationError(X, X_WH));
    margin += LimitMargin(arm, *q);
    elbow += (*q)[3];
  }
  fmt::print("{:<34} {:>6} {:>7.2f} {:>9.1e} {:>9.1e} {:>7.2f}\n", name, count,
             100.0 * solved / count, position, rotation, margin / std::max(1, solved));
}

// Where a posture that made the pose had its joints does not count; the way must be whole.
void Paths(const Arm& arm, const std::string& name, int count, bool planned) {
  const ArmGeometry geometry = *GeometryOf(arm);
  RandomEngine engine = MakeStream(kSeed, 0, "arm paths");
  int whole = 0, flips = 0;
  double largest = 0, bend = 0, made = 0, speed = 0;
  for (int n = 0; n < count; ++n) {
    Eigen::VectorXd a = RandomPosture(arm, engine), b = RandomPosture(arm, engine);
    // Within 90 % of the ranges, so that the margin kept from them hides nothing.
    const auto inner = [&](Eigen::VectorXd& q) {
      for (int i = 0; i < 7; ++i) {
        const double middle = 0.5 * (geometry.lower[i] + geometry.upper[i]);
        q[i] = middle + 0.9 * (q[i] - middle);
      }
    };
    inner(a);
    inner(b);
    std::vector<Pose> X_WH;
    for (int k = 0; k < kPathPoses; ++k) {
      X_WH.push_back(HandPose(arm, a + MinimumJerkPosition(k / (kPathPoses - 1.0)) * (b - a)));
    }
    ArmPath path;
    if (planned) {
      SwivelPathRequest request;
      request.X_WH = X_WH;
      request.dt = kDt;
      request.start = a;
      path = PlanSwivelPath(geometry, request);
    } else {
      path = TrackArmPath(arm, X_WH, a, 10);
    }
    if (!path.complete) continue;
    ++whole;
    made += (b - a).cwiseAbs().maxCoeff() * 1.875 / (kPathPoses * kDt);
    bool flip = false;
    double fastest = 0;
    for (int k = 1; k < kPathPoses; ++k) {
      const double step = (path.q[k] - path.q[k - 1]).cwiseAbs().maxCoeff();
      flip = flip || step > kFlip;
      fastest = std::max(fastest, step / kDt);
      largest = std::max(largest, step);
      if (k < 2) continue;
      bend = std::max(bend, (path.q[k] - 2 * path.q[k - 1] + path.q[k - 2]).cwiseAbs().maxCoeff());
    }
    speed += fastest;
    if (flip) ++flips;
  }
  fmt::print("{:<34} {:>6} {:>7.2f} {:>7} {:>9.1f} {:>9.2f} {:>9.2f} {:>9.2f}\n", name, count,
             100.0 * whole / count, flips, kDegrees * largest, kDegrees * bend,
             speed / std::max(1, whole), made / std::max(1, whole));
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  const int poses = argc > 1 ? std::atoi(argv[1]) : 10000;
  const int paths = argc > 2 ? std::atoi(argv[2]) : 500;
  const GraspBodies bodies = MakeGraspBodies();
  const Arm& arm = bodies.documented.arm;
  fmt::print(
      "poses that a random posture has: solved (%), largest error (m, rad), mean margin to "
      "the joint limits (0..1)\n");
  fmt::print("{:<34} {:>6} {:>7} {:>9} {:>9} {:>7}\n", "", "poses", "solved", "m", "rad", "margin");
  ArmIkOptions whole;
  whole.margin = 0;
  Poses(arm, "closed form, whole joint ranges", poses,
        [&](const Pose& X) { return SolveArmIkFromAnywhere(arm, X, whole); });
  Poses(arm, "closed form, 0.02 rad off the limits", poses,
        [&](const Pose& X) { return SolveArmIkFromAnywhere(arm, X); });
  Poses(arm, "Levenberg-Marquardt, 24 starts", poses / 20, [&](const Pose& X) {
    return SolveArmNumericallyFromAnywhere(arm, X, whole, std::nullopt);
  });
  fmt::print(
      "\npaths of {} poses, every {:.0f} ms, that a quintic between two random postures "
      "makes: whole (%), with a flip (a joint over {:.0f} degrees between poses), largest "
      "step and bend (degrees), mean of the paths' largest joint speed and of that of the "
      "joints that made them (rad/s)\n",
      kPathPoses, 1e3 * kDt, kDegrees * kFlip);
  fmt::print("{:<34} {:>6} {:>7} {:>7} {:>9} {:>9} {:>9} {:>9}\n", "", "paths", "whole", "flips",
             "step", "bend", "speed", "made by");
  Paths(arm, "elbow planned over the path", paths, true);
  Paths(arm, "pose by pose", paths, false);
  return 0;
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return StatisticsMain(argc, argv, springgrasp::Main); }
