// Made-up grasps for tests: a minimum-jerk reach whose fingers open to a peak at 65 % of it and
// close on the object, with the tracker's noise, rate and gaps.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "demonstration/demonstration.h"
#include "grasp/grasp_frame.h"

namespace springgrasp {

struct SyntheticGrasp {
  std::string type = "pinch";
  Shape shape;                  // sphere or upright cylinder
  double duration = 1.0;        // s, of the reach
  double rate = 100;            // Hz
  double opening = 0.035;       // m, every finger at the peak beyond its contact
  double start = 0.015;         // m, the same at the start
  double peak = 0.65;           // fraction of the duration
  double tip_noise = 0;         // m, deviation of every tip coordinate
  double hand_noise = 0;        // m, of every wrist coordinate
  double hand_angle_noise = 0;  // rad
  double missing = 0;           // probability that a tip is not seen
  double tip_radius = 0.008;    // m
  Eigen::Vector3d start_from = {0.05, -0.28, 0.08};  // m, hand at the start less hand at contact
  Pose X_WO = Pose::Identity();
  bool wrist = true;
  bool orientation = true;
};

inline double MinimumJerkStep(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 - 15 * s + 6 * s * s);
}

// The hand beside the object: x_G along O's x, z_G (towards the wrist) along -y of O, so that a
// right hand comes from -y with its thumb side up.
inline Pose SyntheticGraspInObject() {
  Eigen::Matrix3d R;
  R.col(0) = Eigen::Vector3d::UnitX();
  R.col(1) = Eigen::Vector3d::UnitZ();
  R.col(2) = -Eigen::Vector3d::UnitY();
  return MakePose(Eigen::Vector3d::Zero(), Eigen::Quaterniond(R));
}

// Tip centres at contact in G (y_G is O's z) and their outward normals.
inline void SyntheticContacts(const SyntheticGrasp& grasp, PerFinger<Eigen::Vector3d>& p_GC,
                              PerFinger<Eigen::Vector3d>& n_G) {
  const double reach = 0.5 * grasp.shape.size.x() + grasp.tip_radius;
  const bool ball = grasp.shape.kind == Shape::Kind::kSphere;
  const double angles[kNumFingers] = {M_PI, 0.35, -0.35, -0.6, -0.9};
  for (int i = 0; i < kNumFingers; ++i) {
    double angle = i == kThumb ? M_PI : 0.0;
    double height = 0;
    if (grasp.type == "tripod") angle = angles[i];
    if (grasp.type == "power" && i > 0) height = 0.03 - 0.02 * (i - 1);
    const double along = ball && grasp.type == "tripod" ? std::sin(angle) : 0.0;
    n_G[i] = Eigen::Vector3d(std::cos(angle), along, 0);
    p_GC[i] = reach * n_G[i] + Eigen::Vector3d(0, height, 0);
  }
  const PerFinger<bool> involved = InvolvedFingers(grasp.type);
  for (int i = 1; i < kNumFingers; ++i) {
    // Fingers that take no part stay open beside the index finger.
    if (involved[i]) continue;
    p_GC[i] = p_GC[kIndex] + Eigen::Vector3d(0.03 + 0.005 * i, -0.022 * (i - 1), -0.01);
    n_G[i] = Eigen::Vector3d::UnitX();
  }
}

inline Pose SyntheticGraspInHand() {
  Eigen::Matrix3d R;  // x_G out of the back of the hand, z_G towards the wrist
  R.col(0) = Eigen::Vector3d::UnitZ();
  R.col(1) = Eigen::Vector3d::UnitY();
  R.col(2) = -Eigen::Vector3d::UnitX();
  return MakePose(Eigen::Vector3d(0.13, 0, -0.04), Eigen::Quaterniond(R));
}

inline Demonstration MakeDemonstration(const SyntheticGrasp& grasp, RandomEngine& engine) {
  Demonstration demonstration;
  demonstration.source = "synthetic " + grasp.type;
  demonstration.object = DemonstratedObject{grasp.shape, grasp.X_WO};
  PerFinger<Eigen::Vector3d> p_GC, n_G;
  SyntheticContacts(grasp, p_GC, n_G);
  const PerFinger<bool> involved = InvolvedFingers(grasp.type);
  const Pose X_HG = SyntheticGraspInHand();
  const Pose X_WH_end = grasp.X_WO * SyntheticGraspInObject() * X_HG.inverse();
  const double lead = 0.1, hold = 0.3;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * Normal(engine), sigma * Normal(engine), sigma * Normal(engine));
  };
  for (double t = 0; t < lead + grasp.duration + hold; t += 1 / grasp.rate) {
    const double s = (t - lead) / grasp.duration;
    const double left = 1 - MinimumJerkStep(s);
    Pose X_WH = X_WH_end;
    X_WH.translation() += grasp.X_WO.linear() * grasp.start_from * left;
    X_WH.linear() =
        X_WH_end.linear() * ExpRotation(Eigen::Vector3d(0.2, -0.3, 0.1) * left).toRotationMatrix();
    const double open =
        s < grasp.peak
            ? grasp.start + (grasp.opening - grasp.start) * MinimumJerkStep(s / grasp.peak)
            : grasp.opening * (1 - MinimumJerkStep((s - grasp.peak) / (1 - grasp.peak)));
    DemonstrationSample sample;
    sample.t = t;
    const Eigen::Vector3d p_WH = X_WH.translation() + noise(grasp.hand_noise);
    const Eigen::Quaterniond R_WH =
        Eigen::Quaterniond(X_WH.linear()) * ExpRotation(noise(grasp.hand_angle_noise));
    if (grasp.wrist) sample.p_WH = p_WH;
    if (grasp.wrist && grasp.orientation) sample.R_WH = R_WH;
    for (int i = 0; i < kNumFingers; ++i) {
      const double share = involved[i] ? 1.0 : 0.3;
      const Eigen::Vector3d p_WF =
          X_WH * X_HG * (p_GC[i] + share * open * n_G[i]) + noise(grasp.tip_noise);
      if (Uniform01(engine) < grasp.missing) continue;
      if (!grasp.wrist && i > kIndex) continue;
      sample.p_WF[i] = p_WF;
      sample.confidence[i] = 1;
    }
    demonstration.samples.push_back(sample);
  }
  return demonstration;
}

}  // namespace springgrasp
