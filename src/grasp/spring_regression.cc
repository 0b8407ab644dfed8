#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "grasp/spring_estimation.h"

namespace springgrasp {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

void RegressionRows(const SpringSystem& system, const Eigen::Ref<const MatrixXd>& p,
                    const Eigen::Ref<const MatrixXd>& v, const Eigen::Ref<const MatrixXd>& a,
                    double f, SpringTerms& terms, Eigen::Ref<MatrixXd> X, Eigen::Ref<VectorXd> b) {
  terms.f.setConstant(system.num_fingers(), f);
  RegressionRows(system, p, v, a, terms.f, terms, X, b);
}

void RegressionRows(const SpringSystem& system, const Eigen::Ref<const MatrixXd>& p,
                    const Eigen::Ref<const MatrixXd>& v, const Eigen::Ref<const MatrixXd>& a,
                    const VectorXd& f, SpringTerms& terms, Eigen::Ref<MatrixXd> X,
                    Eigen::Ref<VectorXd> b) {
  EvaluateSprings(system, p, v, f, terms);
  const int dim = system.dim;
  X.setZero();
  for (int i = 0; i < system.num_fingers(); ++i) {
    auto row = b.segment(dim * i, dim);
    row = -system.mass[i] * a.col(i) - system.d0 * v.col(i);
    if (!system.involved[static_cast<std::size_t>(i)]) continue;
    const double f_i = terms.ratio[i] * f[i];
    row -= system.share[i] *
           (system.kc * terms.xc.col(i) + system.dc * v.col(i) + f_i * terms.direction.col(i));
  }
  for (std::size_t e = 0; e < system.springs.size(); ++e) {
    const Spring& spring = system.springs[e];
    const auto column = static_cast<Index>(e);
    X.col(column).segment(dim * spring.i, dim) += terms.x.col(column);
    X.col(column).segment(dim * spring.j, dim) -= terms.x.col(column);
    b.segment(dim * spring.i, dim) -= spring.d * terms.xdot.col(column);
    b.segment(dim * spring.j, dim) += spring.d * terms.xdot.col(column);
  }
}

namespace {

// R and Q'b of [X b] = Q R: all that least squares need, in n + 1 rows.
struct Triangle {
  MatrixXd R;
  VectorXd Qb;
};
Triangle Triangulate(const MatrixXd& X, const VectorXd& b) {
  const Index n = X.cols();
  MatrixXd both(X.rows(), n + 1);
  both << X, b;
  const Eigen::HouseholderQR<MatrixXd> qr(both);
  const MatrixXd upper =
      qr.matrixQR().topRows(std::min<Index>(n + 1, X.rows())).triangularView<Eigen::Upper>();
  return {upper.leftCols(n), upper.col(n)};
}

}  // namespace

SpringRegression SolveRegression(const MatrixXd& X, const VectorXd& b, double rcond) {
  ThrowUnless(X.rows() >= X.cols() && X.cols() > 0 && X.rows() == b.size(),
              "spring regression: {} rows for {} constants", X.rows(), X.cols());
  ThrowUnless(X.allFinite() && b.allFinite(), "spring regression: a row is not finite");
  const Index n = X.cols();
  SpringRegression out;
  // Singular values and V of X are those of R.
  const auto [R, Qb] = Triangulate(X, b);
  out.singular_values = Eigen::JacobiSVD<MatrixXd>(R).singularValues();
  VectorXd scale = X.colwise().norm();
  const double largest = scale.maxCoeff();
  // A spring at its rest length throughout leaves an empty column.
  for (double& value : scale) value = value > 1e-12 * largest && value > 0 ? value : HUGE_VAL;
  const VectorXd inverse_scale = scale.cwiseInverse();
  const Eigen::JacobiSVD<MatrixXd> svd(R * inverse_scale.asDiagonal(),
                                       Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VectorXd& sigma = svd.singularValues();
  VectorXd inverse = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    if (sigma[i] <= rcond * sigma[0] || sigma[i] <= 0) continue;
    inverse[i] = 1 / sigma[i];
    out.rank = static_cast<int>(i) + 1;
  }
  const MatrixXd half = inverse_scale.asDiagonal() * svd.matrixV() * inverse.asDiagonal();
  out.k = half * (svd.matrixU().transpose() * Qb);
  out.condition_number =
      out.rank == n ? sigma[0] / sigma[n - 1] : std::numeric_limits<double>::infinity();
  const double sum = (X * out.k - b).squaredNorm();
  out.residual = std::sqrt(sum / static_cast<double>(X.rows()));
  const auto freedom = static_cast<double>(std::max<Index>(X.rows() - out.rank, 1));
  out.standard_error = (half.rowwise().norm() * std::sqrt(sum / freedom));
  // What lies in the null space is not determined at all.
  for (Index e = 0; e < n; ++e) {
    double hidden = inverse_scale[e] == 0 ? 1 : 0;
    for (Index i = out.rank; i < n; ++i) hidden = std::max(hidden, std::abs(svd.matrixV()(e, i)));
    if (hidden > 1e-6) out.standard_error[e] = std::numeric_limits<double>::infinity();
  }
  return out;
}

VectorXd SolveNonNegative(const MatrixXd& rows, const VectorXd& right) {
  const auto [X, b] = Triangulate(rows, right);
  const Index n = X.cols();
  VectorXd scale = X.colwise().norm();
  for (double& value : scale) value = value > 0 ? value : 1;
  const MatrixXd A = X * scale.cwiseInverse().asDiagonal();
  VectorXd x = VectorXd::Zero(n);
  std::vector<bool> free(static_cast<std::size_t>(n), false);
  const double tolerance = 1e-12 * (1 + b.norm());
  // Least squares over the free columns.
  const auto solve = [&] {
    std::vector<Index> columns;
    for (Index i = 0; i < n; ++i) {
      if (free[static_cast<std::size_t>(i)]) columns.push_back(i);
    }
    const VectorXd part =
        MatrixXd(A(Eigen::all, columns)).completeOrthogonalDecomposition().solve(b);
    VectorXd full = VectorXd::Zero(n);
    for (std::size_t i = 0; i < columns.size(); ++i) full[columns[i]] = part[static_cast<Index>(i)];
    return full;
  };
  for (Index iteration = 0; iteration < 10 * n; ++iteration) {
    const VectorXd gradient = A.transpose() * (b - A * x);
    Index best = -1;
    for (Index i = 0; i < n; ++i) {
      if (free[static_cast<std::size_t>(i)] || gradient[i] <= tolerance) continue;
      if (best < 0 || gradient[i] > gradient[best]) best = i;
    }
    if (best < 0) break;
    free[static_cast<std::size_t>(best)] = true;
    VectorXd candidate = solve();
    // Step back to the first bound until all free constants are positive.
    for (Index inner = 0; inner < n; ++inner) {
      double step = 1;
      for (Index i = 0; i < n; ++i) {
        if (free[static_cast<std::size_t>(i)] && candidate[i] <= 0) {
          step = std::min(step, x[i] / std::max(x[i] - candidate[i], 1e-300));
        }
      }
      x += step * (candidate - x);
      if (step >= 1) break;
      for (Index i = 0; i < n; ++i) {
        if (free[static_cast<std::size_t>(i)] && x[i] <= 1e-14) {
          x[i] = 0;
          free[static_cast<std::size_t>(i)] = false;
        }
      }
      candidate = solve();
    }
  }
  return (scale.cwiseInverse().asDiagonal() * x).cwiseMax(0.0);
}

}  // namespace springgrasp
