// What the forces of Eq. (4) and Eq. (5) and their derivatives share. Only for spring_system.cc and
// spring_jacobian.cc.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "grasp/spring_system.h"

namespace springgrasp::spring_forces {

using Points = Eigen::Ref<const Eigen::MatrixXd>;

template <int Dim>
using Vec = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Mat = Eigen::Matrix<double, Dim, Dim>;

// Fingers that share the force R f.
inline bool InVirtualFinger(const SpringSystem& system, int i) {
  return i > 0 && system.involved[static_cast<std::size_t>(i)];
}

inline bool Outward(const SpringSystem& system, double f) {
  return f < 0 && system.opening == OpeningDirection::kOutward;
}

inline bool Reciprocal(const SpringSystem& system, double f) {
  return f < 0 && system.ratio == ForceRatio::kReciprocal;
}

inline bool Balanced(const SpringSystem& system) { return system.ratio == ForceRatio::kBalanced; }

// Where f is shared by the fingers' distances.
inline bool Shared(const SpringSystem& system, double f) { return Balanced(system) && f > 0; }

// R of Eq. (4) before its cap.
inline double RatioOf(const SpringSystem& system, double rho, double f) {
  if (Balanced(system)) return 1;
  return Reciprocal(system, f) ? 1 / (rho * rho) : rho * rho;
}
// Mean of s over the virtual finger relative to the thumb's (Eq. (4)); 0 where it does not apply.
inline double DistanceRatio(const SpringSystem& system, const Eigen::VectorXd& s, double& count) {
  count = 0;
  if (!system.involved[0]) return 0;
  double sum = 0;
  for (int i = 1; i < system.num_fingers(); ++i) {
    if (!InVirtualFinger(system, i)) continue;
    sum += system.share[i] * s[i];
    count += system.share[i];
  }
  return count == 0 ? 0 : sum / (count * s[0]);
}

// Mean of s over all involved fingers, by their shares.
struct MeanDistance {
  double value = 0, count = 0;
};
inline MeanDistance MeanOf(const SpringSystem& system, const Eigen::VectorXd& s) {
  MeanDistance mean;
  for (int i = 0; i < system.num_fingers(); ++i) {
    if (!system.involved[static_cast<std::size_t>(i)]) continue;
    mean.value += system.share[i] * s[i];
    mean.count += system.share[i];
  }
  if (mean.count > 0) mean.value /= mean.count;
  return mean;
}

// How much of a closing force is shared by distance, the rest being alike for all: all of it but
// between two grasps, where a finger that takes part by half hovers far from its contact.
inline double Sharing(const SpringSystem& system) {
  double sharing = 1;
  for (int i = 0; i < system.num_fingers(); ++i) {
    if (!system.involved[static_cast<std::size_t>(i)]) continue;
    const double whole = 2 * system.share[i] - 1;
    sharing = std::min(sharing, whole * whole);
  }
  return sharing;
}

// Whether the way of finger i back to its contact is bent, and xc as f > 0 sees it then.
inline bool Bent(const SpringSystem& system, int i, double f) {
  return Shared(system, f) && !system.bend.col(i).isZero(0);
}
template <int Dim>
Vec<Dim> BentDistance(const SpringSystem& system, const SpringTerms& terms, int i) {
  const Vec<Dim> xc = terms.xc.col(i);
  return xc - xc.squaredNorm() * system.bend.col(i);
}
// The way on which f < 0 pushes finger i, were it straight.
template <int Dim>
Vec<Dim> OpeningChord(const SpringSystem& system, int i) {
  const Vec<Dim> n = system.normals.col(i), bend = system.opening_bend.col(i);
  const double square = bend.squaredNorm();
  return square > 0 ? Vec<Dim>(n - n.dot(bend) / square * bend) : n;
}

}  // namespace springgrasp::spring_forces
