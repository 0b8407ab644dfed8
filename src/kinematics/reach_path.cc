#include "kinematics/reach_path.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "kinematics/swivel_path.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

constexpr double kBigStep = 0.15;  // rad between samples: a jump

bool SamePose(const Pose& a, const Pose& b) {
  return (a.translation() - b.translation()).norm() < 1e-3 && a.linear().isApprox(b.linear(), 5e-3);
}

// Of any joint, rad/s.
double LargestSpeed(const std::vector<Eigen::VectorXd>& q, double dt) {
  double largest = 0;
  for (std::size_t k = 1; k < q.size(); ++k) {
    largest = std::max(largest, (q[k] - q[k - 1]).cwiseAbs().maxCoeff());
  }
  return largest / dt;
}

// The way as tracked in `q`, its beginning turned within the arm's null space to q_start.
ArmPath TurnedToStart(const Arm& arm, const std::vector<Pose>& X_WH,
                      const std::vector<Eigen::VectorXd>& q_tracked,
                      const Eigen::VectorXd& q_start) {
  ArmPath joined;
  const Eigen::VectorXd difference = q_start - q_tracked.front();
  ArmIkOptions ik;
  ik.limit_weight = 0;
  const std::size_t n = q_tracked.size();
  for (std::size_t k = 0; k < n; ++k) {
    const double rest =
        1 - MinimumJerkPosition(static_cast<double>(k) / (0.8 * static_cast<double>(n)));
    std::optional<Eigen::VectorXd> q = q_tracked[k];
    if (rest > 0) q = SolveArmIk(arm, X_WH[k], q_tracked[k] + rest * difference, ik);
    if (!q) {
      joined.reason = fmt::format("the arm cannot come from its start posture (sample {})", k);
      return joined;
    }
    if (k > 0 && (*q - joined.q.back()).cwiseAbs().maxCoeff() > kBigStep) {
      joined.reason = fmt::format("the arm would jump coming from its start (sample {})", k);
      return joined;
    }
    joined.q.push_back(*q);
  }
  joined.complete = true;
  return joined;
}

bool WithinLimits(const Arm& arm, const std::vector<Eigen::VectorXd>& path) {
  const double margin = ArmIkOptions().margin;
  for (const Eigen::VectorXd& q : path) {
    for (int i = 0; i < arm.num_joints(); ++i) {
      const int j = arm.joints[i];
      if (q[i] < arm.tree.lower[j] + margin || q[i] > arm.tree.upper[j] - margin) {
        return false;
      }
    }
  }
  return true;
}

// Comes straight to sample `join` of a way whose joints are `q_tail` from sample `first` on.
std::optional<ReachPath> Join(const Arm& arm, const ReachPathRequest& request,
                              const std::vector<Eigen::VectorXd>& q_tail, int first, int join) {
  const auto at = [&](int k) -> const Eigen::VectorXd& { return q_tail[k - first]; };
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(arm.num_joints());
  // Time is counted in samples.
  const MinimumJerk quintic = MakeMinimumJerk(
      {*request.q_start, zero, zero},
      {at(join), 0.5 * (at(join + 1) - at(join - 1)), at(join + 1) - 2 * at(join) + at(join - 1)},
      join);
  ReachPath path;
  for (int k = 0; k < join; ++k) path.q.push_back(EvaluateMinimumJerk(quintic, k).x);
  if (!WithinLimits(arm, path.q)) return std::nullopt;
  path.q.insert(path.q.end(), q_tail.begin() + (join - first), q_tail.end());
  if (LargestSpeed(path.q, request.dt) > request.max_speed) return std::nullopt;
  path.X_WH = request.X_WH;
  for (int k = 0; k < join; ++k) path.X_WH[k] = HandPose(arm, path.q[k]);
  if (request.clear && !request.clear(path.X_WH, path.q, join)) return std::nullopt;
  path.join = join;
  path.complete = true;
  return path;
}

int JoinStride(const ReachPathRequest& request) { return std::max(1, request.latest_join / 12); }

int LastJoin(const ReachPathRequest& request) {
  return std::min(request.latest_join, static_cast<int>(request.X_WH.size()) - 2);
}

bool BeginsAtStart(const Arm& arm, const ReachPathRequest& request) {
  return request.q_start && SamePose(HandPose(arm, *request.q_start), request.X_WH.front());
}

// The whole way if the joints are slow enough, else the reason in `path`.
bool TakeWhole(const ReachPathRequest& request, const ArmPath& whole, ReachPath& path) {
  path.reason = whole.reason;
  if (!whole.complete) return false;
  const double speed = LargestSpeed(whole.q, request.dt);
  if (speed > request.max_speed) {
    path.reason = fmt::format("the reach asks for {:.1f} rad/s of a joint, allowed are {:.1f}",
                              speed, request.max_speed);
    return false;
  }
  path.q = whole.q;
  path.X_WH = request.X_WH;
  path.complete = true;
  return true;
}

ReachPath FollowNumerically(const Arm& arm, const ReachPathRequest& request) {
  const std::vector<Pose> reversed(request.X_WH.rbegin(), request.X_WH.rend());
  ArmPath tracked = TrackArmPath(arm, reversed, request.q_goal, kBigStep);
  std::reverse(tracked.q.begin(), tracked.q.end());
  ReachPath path;
  path.reason = tracked.reason;
  if (tracked.complete &&
      TakeWhole(request,
                BeginsAtStart(arm, request)
                    ? TurnedToStart(arm, request.X_WH, tracked.q, *request.q_start)
                    : tracked,
                path)) {
    return path;
  }
  if (!request.q_start) return path;
  const int first = static_cast<int>(request.X_WH.size() - tracked.q.size());
  for (int join = JoinStride(request); join <= LastJoin(request); join += JoinStride(request)) {
    if (join <= first) continue;
    if (auto joined = Join(arm, request, tracked.q, first, join)) return *joined;
  }
  return path;
}

}  // namespace

ReachPath FollowReach(const Arm& arm, const ReachPathRequest& request) {
  ThrowUnless(!request.X_WH.empty(), "a reach needs poses of the hand");
  const std::optional<ArmGeometry> geometry = GeometryOf(arm);
  if (!geometry) return FollowNumerically(arm, request);
  SwivelPathRequest swivel;
  swivel.X_WH = request.X_WH;
  swivel.dt = request.dt;
  swivel.goal = request.q_goal;
  swivel.max_speed = request.max_speed;
  swivel.obstacles = request.obstacles;
  if (BeginsAtStart(arm, request)) swivel.start = request.q_start;
  ReachPath path;
  if (TakeWhole(request, PlanSwivelPath(*geometry, swivel), path)) return path;
  if (!request.q_start) return path;

  swivel.start.reset();
  swivel.origin = request.q_start;
  for (int join = JoinStride(request); join <= LastJoin(request); join += JoinStride(request)) {
    // From one sample earlier, for the velocity at the join.
    const int first = join - 1;
    swivel.X_WH.assign(request.X_WH.begin() + first, request.X_WH.end());
    if (request.obstacles) {
      swivel.obstacles = [&](const SevenJoints& q, int sample) {
        return request.obstacles(q, sample + first);
      };
    }
    const ArmPath tail = PlanSwivelPath(*geometry, swivel);
    if (!tail.complete) continue;
    if (auto joined = Join(arm, request, tail.q, first, join)) return *joined;
  }
  return path;
}

}  // namespace springgrasp
