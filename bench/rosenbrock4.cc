// Compiled as C++17: the uBLAS of Debian 12 does not know C++20.
#include "rosenbrock4.h"

#include <algorithm>
#include <boost/numeric/odeint.hpp>

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
namespace odeint = boost::numeric::odeint;
namespace ublas = boost::numeric::ublas;

// State (p, v, t), p and v finger-major. Time is a state because Odeint's own term for it is only
// of first order here (measured: halving fixed steps halves the error; in this form it falls 16
// times).
class Equations {
 public:
  Equations(const SpringSystem& system, const ForceProfile& force)
      : system_(system),
        force_(force),
        n_(system.num_coordinates()),
        p_(system.dim, system.num_fingers()),
        v_(p_) {}

  void Slope(const ublas::vector<double>& x, ublas::vector<double>& dxdt) {
    Load(x);
    EvaluateSprings(system_, p_, v_, force_.f(x[2 * n_]), terms_);
    for (Index i = 0; i < n_; ++i) {
      dxdt[i] = v_.data()[i];
      dxdt[i + n_] = terms_.acc.data()[i];
    }
    dxdt[2 * n_] = 1;
  }

  void Jacobian(const ublas::vector<double>& x, ublas::matrix<double>& J) {
    Load(x);
    const double t = x[2 * n_], f = force_.f(t);
    EvaluateSprings(system_, p_, v_, f, terms_);
    SpringJacobian(system_, p_, v_, terms_, Jp_, Jv_);
    before_ = terms_.acc;
    constexpr double kStep = 1e-6;
    EvaluateSprings(system_, p_, v_, force_.f(t + kStep), terms_);
    J.clear();
    for (Index i = 0; i < n_; ++i) {
      J(i, i + n_) = 1;
      for (Index j = 0; j < n_; ++j) {
        J(i + n_, j) = Jp_(i, j);
        J(i + n_, j + n_) = Jv_(i, j);
      }
      // By time only the force changes.
      J(i + n_, 2 * n_) = (terms_.acc.data()[i] - before_.data()[i]) / kStep;
    }
  }

 private:
  void Load(const ublas::vector<double>& x) {
    for (Index i = 0; i < n_; ++i) {
      p_.data()[i] = x[i];
      v_.data()[i] = x[i + n_];
    }
  }

  const SpringSystem& system_;
  const ForceProfile& force_;
  Index n_;
  MatrixXd p_, v_, Jp_, Jv_, before_;
  SpringTerms terms_;
};

}  // namespace

MatrixXd IntegrateByRosenbrock4(const SpringSystem& system, const ForceProfile& force,
                                const MatrixXd& p0, const MatrixXd& v0, const VectorXd& times,
                                double tolerance) {
  const Index n = system.num_coordinates();
  Equations equations(system, force);
  const auto slope = [&](const ublas::vector<double>& x, ublas::vector<double>& dxdt, double) {
    equations.Slope(x, dxdt);
  };
  const auto jacobian = [&](const ublas::vector<double>& x, ublas::matrix<double>& J, double,
                            ublas::vector<double>& dfdt) {
    equations.Jacobian(x, J);
    dfdt.clear();
  };
  ublas::vector<double> x(2 * n + 1);
  for (Index i = 0; i < n; ++i) {
    x[i] = p0.data()[i];
    x[i + n] = v0.data()[i];
  }
  x[2 * n] = times[0];
  MatrixXd out(times.size(), n);
  for (Index row = 0; row < times.size(); ++row) {
    double t = row == 0 ? times[0] : times[row - 1];
    while (t < times[row]) {
      const auto kink = std::upper_bound(force.kinks.begin(), force.kinks.end(), t + 1e-12);
      const double stop = kink == force.kinks.end() ? times[row] : std::min(*kink, times[row]);
      odeint::integrate_adaptive(
          odeint::make_controlled<odeint::rosenbrock4<double>>(tolerance, tolerance),
          std::make_pair(slope, jacobian), x, t, stop, std::min(0.01, stop - t));
      t = stop;
    }
    for (Index i = 0; i < n; ++i) out(row, i) = x[i];
  }
  return out;
}

}  // namespace springgrasp
