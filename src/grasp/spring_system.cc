#include "grasp/spring_system.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "grasp/spring_forces.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace spring_forces;  // NOLINT: its only users

template <int Dim>
void Evaluate(const SpringSystem& system, const Points& p, const Points& v, SpringTerms& terms) {
  const int N = system.num_fingers();
  const double eps_c2 = system.eps_c * system.eps_c;
  const double eps_s2 = system.eps_s * system.eps_s;
  terms.acc.setZero();
  for (std::size_t e = 0; e < system.springs.size(); ++e) {
    const Spring& spring = system.springs[e];
    const Vec<Dim> D = p.col(spring.i) - p.col(spring.j);
    const Vec<Dim> V = v.col(spring.i) - v.col(spring.j);
    const double r = std::sqrt(D.squaredNorm() + eps_s2);
    const double stretch = 1 - spring.l / r;
    const Vec<Dim> x = D * stretch;
    Vec<Dim> xdot = V;
    if (system.damping == SpringDamping::kAxial) {
      xdot = D * (D.dot(V) / (r * r));
    } else if (system.damping == SpringDamping::kLiteral) {
      xdot = V * stretch + D * (spring.l * D.dot(V) / (r * r * r));
    }
    const auto column = static_cast<Index>(e);
    terms.x.col(column) = x;
    terms.xdot.col(column) = xdot;
    const Vec<Dim> force = spring.k * x + spring.d * xdot;
    terms.acc.col(spring.i) -= force;
    terms.acc.col(spring.j) += force;
  }
  for (int i = 0; i < N; ++i) {
    const Vec<Dim> y = p.col(i) - system.anchors.col(i);
    const double q = std::sqrt(y.squaredNorm() + eps_c2);
    const Vec<Dim> xc = y * (1 - system.rest_radius[i] / q);
    const double s = std::sqrt(xc.squaredNorm() + eps_c2);
    terms.xc.col(i) = xc;
    terms.s[i] = s;
    terms.u.col(i) = xc / s;
    terms.direction.col(i) = terms.u.col(i);
    terms.ratio[i] = 1;
    if (Bent(system, i, terms.f[i])) {
      const Vec<Dim> bent = BentDistance<Dim>(system, terms, i);
      // With this length for the direction, ratio and direction together are xc bent / mean s.
      terms.ratio[i] = std::sqrt(bent.squaredNorm() + eps_c2);
      terms.direction.col(i) = bent / terms.ratio[i];
    } else if (Shared(system, terms.f[i])) {
      terms.ratio[i] = s;
    }
    if (!Outward(system, terms.f[i])) continue;
    if (system.rest_radius[i] > 0) {
      terms.direction.col(i) = y / q;
    } else if (!system.normals.col(i).isZero(0)) {
      terms.direction.col(i) =
          system.normals.col(i) + OpeningChord<Dim>(system, i).dot(y) * system.opening_bend.col(i);
    }
  }
  double count = 0;
  const double rho = DistanceRatio(system, terms.s, count);
  const MeanDistance mean = MeanOf(system, terms.s);
  const double sharing = Sharing(system);
  terms.R = 1;
  for (int i = 0; i < N; ++i) {
    if (system.involved[static_cast<std::size_t>(i)]) {
      if (Shared(system, terms.f[i])) {
        terms.ratio[i] /= mean.value;
        if (sharing < 1) {
          terms.direction.col(i) =
              (sharing * terms.ratio[i]) * terms.direction.col(i) + (1 - sharing) * terms.u.col(i);
          terms.ratio[i] = 1;
        }
      } else if (i > 0 && count > 0) {
        terms.ratio[i] = terms.R = std::min(RatioOf(system, rho, terms.f[i]), system.r_max);
      }
      const double f_i = terms.ratio[i] * terms.f[i];
      terms.acc.col(i) -= system.share[i] * (system.kc * terms.xc.col(i) + system.dc * v.col(i) +
                                             f_i * terms.direction.col(i));
    }
    if (system.d0 != 0) terms.acc.col(i) -= system.d0 * v.col(i);
    terms.acc.col(i) /= system.mass[i];
  }
}

}  // namespace

SpringSystem MakeSpringSystem(int num_fingers, int dim, double mass) {
  SpringSystem system;
  system.dim = dim;
  system.mass = Eigen::VectorXd::Constant(num_fingers, mass);
  system.anchors = MatrixXd::Zero(dim, num_fingers);
  system.normals = system.opening_bend = system.bend = MatrixXd::Zero(dim, num_fingers);
  system.rest_radius = Eigen::VectorXd::Zero(num_fingers);
  system.involved.assign(static_cast<std::size_t>(num_fingers), false);
  system.share = Eigen::VectorXd::Ones(num_fingers);
  return system;
}

void CheckSpringSystem(const SpringSystem& system) {
  const int N = system.num_fingers();
  ThrowUnless(system.dim == 2 || system.dim == 3, "spring system: dim is {}, not 2 or 3",
              system.dim);
  ThrowUnless(N >= 1 && system.anchors.rows() == system.dim && system.anchors.cols() == N &&
                  system.normals.rows() == system.dim && system.normals.cols() == N &&
                  system.opening_bend.rows() == system.dim && system.opening_bend.cols() == N &&
                  system.bend.rows() == system.dim && system.bend.cols() == N &&
                  system.rest_radius.size() == N && static_cast<int>(system.involved.size()) == N &&
                  system.share.size() == N,
              "spring system: anchors, normals, bends, radii, involved and share do not fit "
              "{} fingers in {}-D",
              N, system.dim);
  ThrowUnless(system.mass.minCoeff() > 0 && system.mass.allFinite(),
              "spring system: every mass must be positive");
  ThrowUnless(system.eps_s > 0 && system.eps_c > 0,
              "spring system: soft-norm lengths must be positive");
  ThrowUnless(system.r_max > 0, "spring system: the cap of the force ratio must be positive");
  for (const Spring& spring : system.springs) {
    ThrowUnless(
        spring.i >= 0 && spring.i < N && spring.j >= 0 && spring.j < N && spring.i != spring.j,
        "spring system: spring ({}, {}) does not join two of {} fingers", spring.i, spring.j, N);
  }
}

std::vector<std::pair<int, int>> SpringTopology(std::string_view name) {
  if (name == "chain4") return {{0, 1}, {1, 2}, {2, 3}, {3, 4}};
  if (name == "ring5") return {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {0, 4}};
  if (name == "fan7") return {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}, {2, 3}, {3, 4}};
  if (name == "brace9") {
    return {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}, {2, 3}, {3, 4}, {1, 3}, {2, 4}};
  }
  if (name == "full10") {
    return {{0, 1}, {0, 2}, {0, 3}, {0, 4}, {1, 2}, {1, 3}, {1, 4}, {2, 3}, {2, 4}, {3, 4}};
  }
  Fail("unknown spring topology '{}': valid are fan7, brace9, chain4, ring5, full10", name);
}

void EvaluateSprings(const SpringSystem& system, const Eigen::Ref<const MatrixXd>& p,
                     const Eigen::Ref<const MatrixXd>& v, double f, SpringTerms& terms) {
  terms.f.setConstant(system.num_fingers(), f);
  EvaluateSprings(system, p, v, terms.f, terms);
}

void EvaluateSprings(const SpringSystem& system, const Eigen::Ref<const MatrixXd>& p,
                     const Eigen::Ref<const MatrixXd>& v, const Eigen::VectorXd& f,
                     SpringTerms& terms) {
  const auto E = static_cast<Index>(system.springs.size());
  const Index N = system.num_fingers();
  terms.x.resize(system.dim, E);
  terms.xdot.resize(system.dim, E);
  terms.xc.resize(system.dim, N);
  terms.u.resize(system.dim, N);
  terms.direction.resize(system.dim, N);
  terms.acc.resize(system.dim, N);
  terms.s.resize(N);
  terms.ratio.resize(N);
  if (&f != &terms.f) terms.f = f;
  if (system.dim == 2) {
    Evaluate<2>(system, p, v, terms);
  } else {
    Evaluate<3>(system, p, v, terms);
  }
}

double SpringEnergy(const SpringSystem& system, const Eigen::Ref<const MatrixXd>& p,
                    const Eigen::Ref<const MatrixXd>& v) {
  double energy = 0;
  for (const Spring& spring : system.springs) {
    const double r =
        std::sqrt((p.col(spring.i) - p.col(spring.j)).squaredNorm() + system.eps_s * system.eps_s);
    energy += 0.5 * spring.k * (r - spring.l) * (r - spring.l);
  }
  for (int i = 0; i < system.num_fingers(); ++i) {
    energy += 0.5 * system.mass[i] * v.col(i).squaredNorm();
    if (!system.involved[static_cast<std::size_t>(i)]) continue;
    const double q =
        std::sqrt((p.col(i) - system.anchors.col(i)).squaredNorm() + system.eps_c * system.eps_c);
    const double stretch = q - system.rest_radius[i];
    energy += 0.5 * system.share[i] * system.kc * stretch * stretch;
  }
  return energy;
}

}  // namespace springgrasp
