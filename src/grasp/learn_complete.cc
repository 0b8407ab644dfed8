#include "grasp/learn_complete.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "grasp/object_contacts.h"
#include "motion/minimum_jerk.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double kNear = 0.06;  // s: seen that close to an end is seen there

// Of a minimum-jerk movement from one step to another, at step n.
double Progress(int n, int from, int to) {
  return MinimumJerkPosition(std::clamp(static_cast<double>(n - from) / (to - from), 0.0, 1.0));
}

// First and last step of the track at which the finger was seen.
struct SeenSteps {
  int first = -1, last = -1;
};
SeenSteps StepsSeen(const HandTrack& track, const ReachSegment& reach, int finger) {
  SeenSteps seen;
  for (std::size_t n = 0; n < track.sample_t.size(); ++n) {
    if (!track.sample_p_HF[n][finger]) continue;
    const int step = static_cast<int>(std::lround(track.sample_t[n] / track.dt));
    if (seen.first < 0 && step >= reach.begin) seen.first = step;
    if (step <= reach.contact) seen.last = step;
  }
  return seen;
}

// Place at `from` and way to `to` of the minimum-jerk movement between these steps that fits the
// track best in [first, last]; a column each.
Eigen::Matrix<double, 3, 2> FitMovement(const HandTrack& track, int finger, int from, int to,
                                        int first, int last) {
  const Index rows = last - first + 1;
  MatrixXd basis(rows, 2), x(rows, 3);
  for (Index k = 0; k < rows; ++k) {
    const int n = first + static_cast<int>(k);
    basis.row(k) << 1, Progress(n, from, to);
    x.row(k) = track.p_HF[static_cast<std::size_t>(n)][finger].transpose();
  }
  return basis.householderQr().solve(x).transpose();
}

// Step at which the hand is widest while the finger is seen.
int WidestStep(const HandTrack& track, const PerFinger<bool>& involved, const SeenSteps& seen) {
  const std::vector<double> span = ThumbFingerSpan(track, involved);
  return static_cast<int>(
      std::max_element(span.begin() + seen.first, span.begin() + seen.last + 1) - span.begin());
}

}  // namespace

SeenAtEnds FindSeenAtEnds(const HandTrack& track, const ReachSegment& reach) {
  const int near = static_cast<int>(kNear / track.dt);
  SeenAtEnds out;
  for (int i = 0; i < kNumFingers; ++i) {
    const SeenSteps seen = StepsSeen(track, reach, i);
    out.begin[i] = seen.first >= 0 && seen.first <= reach.begin + near;
    out.contact[i] = seen.last >= reach.contact - near;
  }
  return out;
}

void CompleteFingers(const SeenAtEnds& seen, const PerFinger<bool>& involved,
                     const ReachSegment& reach, const PerFinger<std::optional<Vector3d>>& p_HC,
                     HandTrack& track) {
  constexpr int kEnough = 8;  // steps that tell how a finger moves
  for (int i = 0; i < kNumFingers; ++i) {
    if (!track.observed[i] || (seen.begin[i] && seen.contact[i])) continue;
    const SeenSteps steps = StepsSeen(track, reach, i);
    if (steps.last - steps.first < kEnough) continue;
    const int widest = WidestStep(track, involved, steps);
    const auto place = [&](int n) -> Vector3d& {
      return track.p_HF[static_cast<std::size_t>(n)][i];
    };
    if (!seen.begin[i] && widest - steps.first >= kEnough) {
      const auto way = FitMovement(track, i, reach.begin, widest, steps.first, widest);
      const auto fit = [&](int n) -> Vector3d {
        return way.col(0) + Progress(n, reach.begin, widest) * way.col(1);
      };
      const Vector3d gap = place(steps.first) - fit(steps.first);
      for (int n = 0; n < steps.first; ++n) {
        place(n) = fit(n) + Progress(n, reach.begin, steps.first) * gap;
      }
    }
    if (!seen.contact[i] && steps.last - widest >= kEnough) {
      const auto way = FitMovement(track, i, widest, reach.contact, widest, steps.last);
      const auto fit = [&](int n) -> Vector3d {
        return way.col(0) + Progress(n, widest, reach.contact) * way.col(1);
      };
      const Vector3d gap = place(steps.last) - fit(steps.last);
      const Vector3d last = p_HC[i] ? Vector3d(*p_HC[i] - fit(reach.contact)) : Vector3d::Zero();
      for (int n = steps.last + 1; n < track.size(); ++n) {
        const double s = Progress(n, steps.last, reach.contact);
        place(n) = fit(n) + (1 - s) * gap + s * last;
      }
    }
  }
}

PerFinger<std::optional<Vector3d>> HiddenContacts(const SeenAtEnds& seen, const Grasp& grasp,
                                                  const PerFinger<Vector3d>& p_HC) {
  PerFinger<std::optional<Vector3d>> hidden;
  const Pose X_HO = grasp.X_OH.inverse();
  const auto touching = [&](const Vector3d& p_OQ) -> Vector3d {
    return X_HO * (p_OQ + grasp.tip_radius * OutwardNormal(grasp.shape, p_OQ));
  };
  Vector3d others = Vector3d::Zero();
  int count = 0;
  for (int i = kIndex; i < kNumFingers; ++i) {
    if (!grasp.involved[i] || !grasp.observed[i]) continue;
    others += grasp.X_OH * p_HC[i];
    ++count;
    if (!seen.contact[i]) {
      hidden[i] = touching(NearestSurfacePoint(grasp.shape, grasp.X_OH * p_HC[i]));
    }
  }
  if (seen.contact[kThumb] || !grasp.involved[kThumb] || count == 0) return hidden;
  others /= count;
  const Vector3d across = -OutwardNormal(grasp.shape, others);
  if (const auto far = RayExit(grasp.shape, others, across)) hidden[kThumb] = touching(*far);
  return hidden;
}

}  // namespace springgrasp
