#include "grasp/spring_system.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Points = Eigen::Ref<const MatrixXd>;

template <int Dim>
using Vec = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Mat = Eigen::Matrix<double, Dim, Dim>;

// Fingers that share the force R f.
bool InVirtualFinger(const SpringSystem& system, int i) {
  return i > 0 && system.involved[static_cast<std::size_t>(i)];
}

bool Outward(const SpringSystem& system, double f) {
  return f < 0 && system.opening == OpeningDirection::kOutward;
}

bool Reciprocal(const SpringSystem& system, double f) {
  return f < 0 && system.ratio == ForceRatio::kReciprocal;
}

bool Balanced(const SpringSystem& system) { return system.ratio == ForceRatio::kBalanced; }

// Where f is shared by the fingers' distances.
bool Shared(const SpringSystem& system, double f) { return Balanced(system) && f > 0; }

// R of Eq. (4) before its cap, and its derivative by rho.
double RatioOf(const SpringSystem& system, double rho, double f) {
  if (Balanced(system)) return 1;
  return Reciprocal(system, f) ? 1 / (rho * rho) : rho * rho;
}
double RatioSlope(const SpringSystem& system, double rho, double f) {
  if (Balanced(system)) return 0;
  return Reciprocal(system, f) ? -2 / (rho * rho * rho) : 2 * rho;
}

// Mean of s over the virtual finger relative to the thumb's (Eq. (4)); 0 where it does not apply.
double DistanceRatio(const SpringSystem& system, const Eigen::VectorXd& s, double& count) {
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
MeanDistance MeanOf(const SpringSystem& system, const Eigen::VectorXd& s) {
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
double Sharing(const SpringSystem& system) {
  double sharing = 1;
  for (int i = 0; i < system.num_fingers(); ++i) {
    if (!system.involved[static_cast<std::size_t>(i)]) continue;
    const double whole = 2 * system.share[i] - 1;
    sharing = std::min(sharing, whole * whole);
  }
  return sharing;
}

// Whether the way of finger i back to its contact is bent, xc as f > 0 sees it then, and the
// derivative of that by xc.
bool Bent(const SpringSystem& system, int i, double f) {
  return Shared(system, f) && !system.bend.col(i).isZero(0);
}
template <int Dim>
Vec<Dim> BentDistance(const SpringSystem& system, const SpringTerms& terms, int i) {
  const Vec<Dim> xc = terms.xc.col(i);
  return xc - xc.squaredNorm() * system.bend.col(i);
}
template <int Dim>
Mat<Dim> BentDerivative(const SpringSystem& system, const SpringTerms& terms, int i, double f) {
  const Mat<Dim> I = Mat<Dim>::Identity();
  if (!Bent(system, i, f)) return I;
  const Vec<Dim> xc = terms.xc.col(i);
  const Vec<Dim> bend = system.bend.col(i);
  return I - 2 * bend * xc.transpose();
}

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
      terms.direction.col(i) = system.normals.col(i);
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

template <int Dim>
void AddSpringDerivatives(const SpringSystem& system, const Points& p, const Points& v,
                          MatrixXd& Jp, MatrixXd& Jv) {
  const Mat<Dim> I = Mat<Dim>::Identity();
  for (const Spring& spring : system.springs) {
    const Vec<Dim> D = p.col(spring.i) - p.col(spring.j);
    const Vec<Dim> V = v.col(spring.i) - v.col(spring.j);
    const double r2 = D.squaredNorm() + system.eps_s * system.eps_s;
    const double r = std::sqrt(r2);
    const Mat<Dim> DDt = D * D.transpose();
    const double DV = D.dot(V);
    const double l = spring.l;
    const Mat<Dim> dx = (1 - l / r) * I + (l / (r2 * r)) * DDt;
    Mat<Dim> dxdot_dD = Mat<Dim>::Zero();
    Mat<Dim> dxdot_dV = I;
    if (system.damping == SpringDamping::kAxial) {
      dxdot_dD = (DV * I + D * V.transpose()) / r2 - (2 * DV / (r2 * r2)) * DDt;
      dxdot_dV = DDt / r2;
    } else if (system.damping == SpringDamping::kLiteral) {
      const double c = l / (r2 * r);
      dxdot_dD = c * (V * D.transpose() + DV * I + D * V.transpose()) - (3 * c * DV / r2) * DDt;
      dxdot_dV = dx;
    }
    const Mat<Dim> dF_dD = spring.k * dx + spring.d * dxdot_dD;
    const Mat<Dim> dF_dV = spring.d * dxdot_dV;
    const Index a = Dim * spring.i, b = Dim * spring.j;
    Jp.template block<Dim, Dim>(a, a) -= dF_dD;
    Jp.template block<Dim, Dim>(a, b) += dF_dD;
    Jp.template block<Dim, Dim>(b, a) += dF_dD;
    Jp.template block<Dim, Dim>(b, b) -= dF_dD;
    Jv.template block<Dim, Dim>(a, a) -= dF_dV;
    Jv.template block<Dim, Dim>(a, b) += dF_dV;
    Jv.template block<Dim, Dim>(b, a) += dF_dV;
    Jv.template block<Dim, Dim>(b, b) -= dF_dV;
  }
}

// d xc_i / d p_i.
template <int Dim>
Mat<Dim> ContactDerivative(const SpringSystem& system, const Points& p, int i) {
  const Vec<Dim> y = p.col(i) - system.anchors.col(i);
  const double L = system.rest_radius[i];
  const double q2 = y.squaredNorm() + system.eps_c * system.eps_c;
  const double q = std::sqrt(q2);
  return (1 - L / q) * Mat<Dim>::Identity() + (L / (q2 * q)) * (y * y.transpose());
}

// d direction_i / d p_i.
template <int Dim>
Mat<Dim> DirectionDerivative(const SpringSystem& system, const Points& p, const SpringTerms& terms,
                             int i, double f) {
  const Mat<Dim> I = Mat<Dim>::Identity();
  if (Outward(system, f) && system.rest_radius[i] > 0) {
    const Vec<Dim> y = p.col(i) - system.anchors.col(i);
    const double q2 = y.squaredNorm() + system.eps_c * system.eps_c;
    return (I - y * y.transpose() / q2) / std::sqrt(q2);
  }
  if (Outward(system, f) && !system.normals.col(i).isZero(0)) return Mat<Dim>::Zero();
  const Vec<Dim> u = terms.u.col(i);
  return (I - u * u.transpose()) / terms.s[i] * ContactDerivative<Dim>(system, p, i);
}

template <int Dim>
void Jacobian(const SpringSystem& system, const Points& p, const Points& v,
              const SpringTerms& terms, MatrixXd& Jp, MatrixXd& Jv) {
  const int N = system.num_fingers();
  Jp.setZero();
  Jv.setZero();
  AddSpringDerivatives<Dim>(system, p, v, Jp, Jv);
  const Mat<Dim> I = Mat<Dim>::Identity();
  double count = 0;
  const double rho = DistanceRatio(system, terms.s, count);
  const MeanDistance mean = MeanOf(system, terms.s);
  const double sharing = Sharing(system);
  for (int i = 0; i < N; ++i) {
    const Index a = Dim * i;
    if (system.involved[static_cast<std::size_t>(i)]) {
      const double f = terms.f[i];
      const Mat<Dim> dxc = ContactDerivative<Dim>(system, p, i);
      Mat<Dim> dforce = system.kc * dxc;
      if (Shared(system, f)) {
        // f xc bent / mean s, at a fixed mean.
        dforce += (sharing * f / mean.value) * BentDerivative<Dim>(system, terms, i, f) * dxc;
        if (sharing < 1) {
          const Vec<Dim> u = terms.u.col(i);
          dforce += ((1 - sharing) * f / terms.s[i]) * (I - u * u.transpose()) * dxc;
        }
      } else {
        dforce += (terms.ratio[i] * f) * DirectionDerivative<Dim>(system, p, terms, i, f);
      }
      Jp.template block<Dim, Dim>(a, a) -= system.share[i] * dforce;
      Jv.template block<Dim, Dim>(a, a) -= system.share[i] * system.dc * I;
    }
    Jv.template block<Dim, Dim>(a, a) -= system.d0 * I;
  }
  // The ratios, by the distance of every finger.
  for (int j = 0; j < N; ++j) {
    if (!system.involved[static_cast<std::size_t>(j)]) continue;
    const Vec<Dim> u_j = terms.u.col(j);
    const Vec<Dim> ds_dp = ContactDerivative<Dim>(system, p, j).transpose() * u_j;
    const double drho_ds =
        count == 0 ? 0 : (j == 0 ? -rho / terms.s[0] : system.share[j] / (count * terms.s[0]));
    for (int i = 0; i < N; ++i) {
      if (!system.involved[static_cast<std::size_t>(i)]) continue;
      double slope = 0;
      if (Shared(system, terms.f[i])) {
        const Vec<Dim> way = Bent(system, i, terms.f[i]) ? BentDistance<Dim>(system, terms, i)
                                                         : Vec<Dim>(terms.xc.col(i));
        const double part = -sharing / (mean.value * mean.value) * system.share[j] / mean.count;
        Jp.template block<Dim, Dim>(Dim * i, Dim * j) -=
            (system.share[i] * terms.f[i] * part) * way * ds_dp.transpose();
        continue;
      }
      if (i > 0 && count > 0 && terms.ratio[i] < system.r_max) {
        slope = RatioSlope(system, rho, terms.f[i]) * drho_ds;  // zero where the cap holds
      }
      if (slope == 0 || terms.f[i] == 0) continue;
      const Vec<Dim> direction = terms.direction.col(i);
      Jp.template block<Dim, Dim>(Dim * i, Dim * j) -=
          (system.share[i] * terms.f[i] * slope) * direction * ds_dp.transpose();
    }
  }
  for (int i = 0; i < N; ++i) {
    Jp.template middleRows<Dim>(Dim * i) /= system.mass[i];
    Jv.template middleRows<Dim>(Dim * i) /= system.mass[i];
  }
}

}  // namespace

SpringSystem MakeSpringSystem(int num_fingers, int dim, double mass) {
  SpringSystem system;
  system.dim = dim;
  system.mass = Eigen::VectorXd::Constant(num_fingers, mass);
  system.anchors = MatrixXd::Zero(dim, num_fingers);
  system.normals = system.bend = MatrixXd::Zero(dim, num_fingers);
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
                  system.bend.rows() == system.dim && system.bend.cols() == N &&
                  system.rest_radius.size() == N && static_cast<int>(system.involved.size()) == N &&
                  system.share.size() == N,
              "spring system: anchors, normals, bend, radii, involved and share do not fit "
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

void SpringJacobian(const SpringSystem& system, const Eigen::Ref<const MatrixXd>& p,
                    const Eigen::Ref<const MatrixXd>& v, const SpringTerms& terms,
                    MatrixXd& dacc_dp, MatrixXd& dacc_dv) {
  const Index n = system.num_coordinates();
  dacc_dp.resize(n, n);
  dacc_dv.resize(n, n);
  if (system.dim == 2) {
    Jacobian<2>(system, p, v, terms, dacc_dp, dacc_dv);
  } else {
    Jacobian<3>(system, p, v, terms, dacc_dp, dacc_dv);
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
