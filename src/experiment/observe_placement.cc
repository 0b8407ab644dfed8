#include "experiment/observe_placement.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "grasp/object_contacts.h"

namespace springgrasp {
namespace {

constexpr double kPalmRadius = 0.012;  // m, of the metacarpals as segments, at kMmmHandLength

// One instant of the motion in its own frame M.
struct Instant {
  bool late = false;  // in the second half, where the grasp happens
  HandShape shape;    // tips and chains in M
  Eigen::Vector3d wrist, palm_normal;
};

std::vector<Instant> InstantsOf(const DemonstratorHand& hand, const HandMotion& motion, int count) {
  std::vector<Instant> instants;
  const double begin = motion.samples.front().t, end = motion.samples.back().t;
  for (int i = 0; i < count; ++i) {
    const double t = begin + (end - begin) * i / (count - 1);
    const HandMotionSample sample = Interpolated(motion, t);
    Instant instant;
    instant.late = t > end / 2;
    instant.shape = ComputeHandShape(hand, sample.q);
    for (int f = 0; f < kNumFingers; ++f) {
      instant.shape.tips[f] = sample.X_WH * instant.shape.tips[f];
      for (Eigen::Vector3d& p : instant.shape.chains[f]) p = sample.X_WH * p;
    }
    instant.wrist = sample.X_WH.translation();
    instant.palm_normal = -sample.X_WH.linear().col(2);
    instants.push_back(std::move(instant));
  }
  return instants;
}

// Distance between segments ab and cd, m.
double SegmentDistance(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                       const Eigen::Vector3d& d) {
  const Eigen::Vector3d u = b - a, v = d - c, w = a - c;
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double denominator = uu * vv - uv * uv;
  double s = denominator > 1e-12 ? std::clamp((uv * vw - vv * uw) / denominator, 0.0, 1.0) : 0.0;
  const double t = vv > 1e-12 ? std::clamp((uv * s + vw) / vv, 0.0, 1.0) : 0.0;
  s = uu > 1e-12 ? std::clamp((uv * t - uw) / uu, 0.0, 1.0) : 0.0;
  return (w + s * u - t * v).norm();
}

// Part of the tip of finger f that an eye at p_ME sees, 0..1, by how far the line of sight passes
// from the object and the other parts of the hand: half where it just touches.
double Seen(const DemonstratorHand& hand, const Instant& instant, const HandMotion& motion,
            const Eigen::Vector3d& p_ME, int f) {
  const Eigen::Vector3d& tip = instant.shape.tips[f];
  double clearance = 1;
  if (motion.object) {
    const Pose X_OM = motion.object->X_WO.inverse();
    const Eigen::Vector3d direction = (p_ME - tip).normalized();
    for (double along = 0.004; along < 0.2; along += 0.006) {
      clearance = std::min(
          clearance,
          SignedDistance(motion.object->shape, X_OM * Eigen::Vector3d(tip + along * direction)));
    }
  }
  for (int g = 0; g < kNumFingers; ++g) {
    const auto& chain = instant.shape.chains[g];
    // The metacarpal, then the segments; of the own finger not the last two.
    clearance = std::min(clearance, SegmentDistance(p_ME, tip, instant.wrist, chain[0]) -
                                        hand.scale() * kPalmRadius);
    const std::size_t segments = chain.size() - 1 - (g == f ? 2 : 0);
    for (std::size_t k = 0; k < segments; ++k) {
      clearance = std::min(clearance,
                           SegmentDistance(p_ME, tip, chain[k], chain[k + 1]) - hand.finger_radius);
    }
  }
  return std::clamp(0.5 + clearance / (2 * hand.tip_radius), 0.0, 1.0);
}

// How well neighbouring caps are told apart along a direction of view: 1 if none overlap, 0 if each
// hides the next.
double Separation(const PerFinger<Eigen::Vector3d>& tips, double cap_radius,
                  const Eigen::Vector3d& view) {
  constexpr double kGap = 0.002;  // m
  const double apart = 2 * cap_radius + kGap;
  double sum = 0;
  for (int f = 0; f + 1 < kNumFingers; ++f) {
    sum += std::min(1.0, view.cross(tips[f + 1] - tips[f]).norm() / apart);
  }
  return sum / (kNumFingers - 1);
}

class Search {
 public:
  Search(const DemonstratorHand& hand, const HandMotion& motion, const StereoCameras& eyes,
         const DisplayOptions& options)
      : hand_(hand),
        motion_(motion),
        eyes_(eyes),
        options_(options),
        instants_(InstantsOf(hand, motion, 18)) {
    const Pose &L = eyes.left.X_WC, &R = eyes.right.X_WC;
    p_WE_ = (L.translation() + R.translation()) / 2;
    forward_ = (L.linear().col(2) + R.linear().col(2)).normalized();
    right_ = (R.translation() - L.translation()).normalized();
    down_ = forward_.cross(right_);
    for (const Instant& i : instants_) {
      points_.push_back(i.wrist);
      for (int f = 0; f < kNumFingers; ++f) {
        points_.push_back(i.shape.tips[f]);
        points_.push_back(i.shape.chains[f][0]);
      }
    }
  }

  // Pose of M with rotation R whose path is centred in the pictures at distance `depth`.
  Pose Centred(const Eigen::Matrix3d& R, double depth) const {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e9), high = -low;
    for (const Eigen::Vector3d& p_M : points_) {
      const Eigen::Vector3d p = R * p_M;
      const Eigen::Vector3d c(p.dot(right_), p.dot(down_), p.dot(forward_));
      low = low.cwiseMin(c);
      high = high.cwiseMax(c);
    }
    const Eigen::Vector3d middle = (low + high) / 2;
    Pose X_WM = Pose::Identity();
    X_WM.linear() = R;
    X_WM.translation() =
        p_WE_ + forward_ * (depth - middle.z()) - right_ * middle.x() - down_ * middle.y();
    for (int pass = 0; pass < 4; ++pass) {
      const Eigen::Vector4d box = PictureBox(X_WM);
      const double metres_per_px = depth / eyes_.left.fx;
      X_WM.translation() +=
          right_ * ((eyes_.left.width - 1 - box[0] - box[1]) / 2 * metres_per_px) +
          down_ * ((eyes_.left.height - 1 - box[2] - box[3]) / 2 * metres_per_px);
    }
    return X_WM;
  }

  // Lower and upper u, lower and upper v over both pictures; far outside if behind an eye.
  Eigen::Vector4d PictureBox(const Pose& X_WM) const {
    Eigen::Vector4d box(1e9, -1e9, 1e9, -1e9);
    for (int view = 0; view < 2; ++view) {
      for (const Eigen::Vector3d& p_M : points_) {
        const auto pixel = Project(eyes_.view(view), X_WM * p_M);
        if (!pixel) return {-1e4, 1e4, -1e4, 1e4};
        box[0] = std::min(box[0], pixel->x());
        box[1] = std::max(box[1], pixel->x());
        box[2] = std::min(box[2], pixel->y());
        box[3] = std::max(box[3], pixel->y());
      }
    }
    return box;
  }

  void Consider(const Pose& X_WM, double depth) {
    DisplayPlacement place;
    place.X_WM = X_WM;
    const Eigen::Vector4d box = PictureBox(X_WM);
    place.margin_px =
        std::min({box[0], eyes_.left.width - 1 - box[1], box[2], eyes_.left.height - 1 - box[3]});
    const Pose X_MW = X_WM.inverse();
    const Eigen::Vector3d p_ME = X_MW * p_WE_;
    double angle = 0, apart = 0;
    for (const Instant& i : instants_) {
      const Eigen::Vector3d to_eyes = (p_ME - i.wrist).normalized();
      angle += std::acos(std::clamp(i.palm_normal.dot(to_eyes), -1.0, 1.0));
      apart += Separation(i.shape.tips, hand_.size.cap_radius, to_eyes);
    }
    place.palm_deg = angle / double(instants_.size()) * 180 / M_PI;
    double others = 0;
    CountSeen(X_MW, place.visible, others);
    // Nearest depth with margin, palm to the eyes within some 30 degrees, most tips seen.
    const double up = X_WM.linear().row(2).dot(motion_.up);
    const double score = 100 * place.visible + 50 * others +
                         100 * apart / double(instants_.size()) -
                         3 * std::max(0.0, options_.margin_px - place.margin_px) -
                         1.0 * std::max(0.0, place.palm_deg - 30) -
                         30 * std::abs(depth - (options_.near + options_.far) / 2) + 5 * up;
    if (score > best_score_) {
      best_score_ = score;
      best_ = place;
    }
  }

  void ConsiderTurn(const Eigen::Matrix3d& R) {
    const int steps = options_.far > options_.near ? 4 : 0;
    for (int i = 0; i <= steps; ++i) {
      const double depth = options_.near + (options_.far - options_.near) * i / std::max(1, steps);
      Consider(Centred(R, depth), depth);
    }
  }

  const DisplayPlacement& best() const { return best_; }
  const std::vector<Instant>& instants() const { return instants_; }
  Eigen::Vector3d towards_eyes() const { return -forward_; }

 private:
  void CountSeen(const Pose& X_MW, double& involved, double& others) const {
    const Eigen::Vector3d eyes_M[2] = {X_MW * eyes_.left.X_WC.translation(),
                                       X_MW * eyes_.right.X_WC.translation()};
    double counts[2] = {0, 0}, seen[2] = {0, 0};
    for (const Instant& i : instants_) {
      for (int f = 0; f < kNumFingers; ++f) {
        const int group = motion_.involved[f] ? 0 : 1;
        const double weight = i.late ? 2 : 1;
        counts[group] += weight;
        seen[group] += weight * std::min(Seen(hand_, i, motion_, eyes_M[0], f),
                                         Seen(hand_, i, motion_, eyes_M[1], f));
      }
    }
    involved = counts[0] > 0 ? seen[0] / counts[0] : 1;
    others = counts[1] > 0 ? seen[1] / counts[1] : 1;
  }

  const DemonstratorHand& hand_;
  const HandMotion& motion_;
  const StereoCameras& eyes_;
  DisplayOptions options_;
  std::vector<Instant> instants_;
  std::vector<Eigen::Vector3d> points_;
  Eigen::Vector3d p_WE_, forward_, right_, down_;
  DisplayPlacement best_;
  double best_score_ = -1e9;
};

}  // namespace

DisplayPlacement PlaceInDisplay(const DemonstratorHand& hand, const HandMotion& motion,
                                const StereoCameras& eyes, const DisplayOptions& options) {
  Search search(hand, motion, eyes, options);
  const auto about = [](const Eigen::Vector3d& axis, double deg) {
    return Eigen::AngleAxisd(deg * M_PI / 180, axis).toRotationMatrix();
  };
  if (options.upright) {
    for (int deg = 0; deg < 360; deg += 10) {
      search.ConsiderTurn(about(Eigen::Vector3d::UnitZ(), deg));
    }
    return search.best();
  }
  // Palm to the eyes, then rolled and tilted.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const auto& instant : search.instants()) normal += instant.palm_normal;
  const Eigen::Vector3d view = search.towards_eyes();
  const Eigen::Matrix3d facing =
      Eigen::Quaterniond::FromTwoVectors(normal, view).toRotationMatrix();
  const Eigen::Vector3d side = view.unitOrthogonal();
  for (int roll = 0; roll < 360; roll += 20) {
    for (const int tilt : {0, 25}) {
      for (int towards = 0; towards < (tilt == 0 ? 1 : 360); towards += 60) {
        const Eigen::Vector3d axis = about(view, towards) * side;
        search.ConsiderTurn(about(axis, tilt) * about(view, roll) * facing);
      }
    }
  }
  return search.best();
}

}  // namespace springgrasp
