// Analytic derivatives of Eq. (5).
#include <algorithm>
#include <cmath>

#include "grasp/spring_forces.h"
#include "grasp/spring_system.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using namespace spring_forces;  // NOLINT: its only users

// d R / d rho of Eq. (4), before its cap.
double RatioSlope(const SpringSystem& system, double rho, double f) {
  if (Balanced(system)) return 0;
  return Reciprocal(system, f) ? -2 / (rho * rho * rho) : 2 * rho;
}

// d BentDistance / d xc.
template <int Dim>
Mat<Dim> BentDerivative(const SpringSystem& system, const SpringTerms& terms, int i, double f) {
  const Mat<Dim> I = Mat<Dim>::Identity();
  if (!Bent(system, i, f)) return I;
  const Vec<Dim> xc = terms.xc.col(i);
  const Vec<Dim> bend = system.bend.col(i);
  return I - 2 * bend * xc.transpose();
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
  if (Outward(system, f) && !system.normals.col(i).isZero(0)) {
    const Vec<Dim> bend = system.opening_bend.col(i);
    return bend * OpeningChord<Dim>(system, i).transpose();
  }
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

}  // namespace springgrasp
