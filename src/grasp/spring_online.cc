#include "grasp/spring_online.h"

#include <Eigen/QR>
#include <algorithm>

#include "base/error.h"

namespace springgrasp {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

OnlineRegression::OnlineRegression(Index springs)
    : springs_(springs), factor_(MatrixXd::Zero(springs + 1, springs + 1)) {}

void OnlineRegression::Add(const Eigen::Ref<const MatrixXd>& X,
                           const Eigen::Ref<const VectorXd>& b) {
  const Index n = springs_ + 1;
  MatrixXd stacked(n + X.rows(), n);
  stacked.topRows(n) = factor_;
  stacked.bottomRows(X.rows()).leftCols(springs_) = X;
  stacked.bottomRows(X.rows()).rightCols<1>() = b;
  const Eigen::HouseholderQR<MatrixXd> qr(stacked);
  factor_ = qr.matrixQR().topRows(n).triangularView<Eigen::Upper>();
  rows_ += X.rows();
}

SpringRegression OnlineRegression::Solve(double rcond) const {
  ThrowUnless(rows_ >= springs_, "spring estimation: {} usable rows for {} constants", rows_,
              springs_);
  SpringRegression out = SolveRegression(factor_.leftCols(springs_), factor_.rightCols<1>(), rcond);
  // Residual and freedom are those of all rows, not of the E + 1 of the factor.
  const auto of_factor = static_cast<double>(std::max<Index>(factor_.rows() - out.rank, 1));
  const auto of_rows = static_cast<double>(std::max<Index>(rows_ - out.rank, 1));
  out.standard_error *= std::sqrt(of_factor / of_rows);
  out.residual *= std::sqrt(static_cast<double>(factor_.rows()) / static_cast<double>(rows_));
  return out;
}

VectorXd OnlineRegression::SolveNonNegative() const {
  return springgrasp::SolveNonNegative(factor_.leftCols(springs_), factor_.rightCols<1>());
}

MatrixXd StateOfWindow(const Eigen::Ref<const VectorXd>& t, const Eigen::Ref<const MatrixXd>& p) {
  // Times in units of the window, about its middle frame.
  const double scale = t[t.size() - 1] - t[0];
  const VectorXd x = (t.array() - t[t.size() / 2]) / scale;
  MatrixXd powers(t.size(), 4);
  powers.col(0).setOnes();
  for (Index k = 1; k < 4; ++k) powers.col(k) = powers.col(k - 1).cwiseProduct(x);
  const MatrixXd c = powers.householderQr().solve(p);
  MatrixXd state(3, p.cols());
  state.row(0) = c.row(0);
  state.row(1) = c.row(1) / scale;
  state.row(2) = 2 * c.row(2) / (scale * scale);
  return state;
}

OnlineEstimation::OnlineEstimation(const SpringSystem& system, int half_window)
    : system_(system),
      half_window_(half_window),
      regression_(static_cast<Index>(system.springs.size())) {
  CheckSpringSystem(system);
  ThrowUnless(half_window >= 2, "spring estimation: half window is {}, expected at least 2 frames",
              half_window);
  X_.resize(system.num_coordinates(), static_cast<Index>(system.springs.size()));
  b_.resize(system.num_coordinates());
}

void OnlineEstimation::AddFrame(double t, const Eigen::Ref<const MatrixXd>& p, double f) {
  ThrowUnless(p.rows() == system_.dim && p.cols() == system_.num_fingers() && p.allFinite(),
              "spring estimation: frame is {}x{}, expected {}x{} finite numbers", p.rows(),
              p.cols(), system_.dim, system_.num_fingers());
  ThrowUnless(frames_.empty() || t > frames_.back().t,
              "spring estimation: times must increase; {} follows {}", t,
              frames_.empty() ? t : frames_.back().t);
  frames_.push_back({t, f, p.reshaped()});
  const auto window = static_cast<std::size_t>(2 * half_window_ + 1);
  if (frames_.size() > window) frames_.pop_front();
  if (frames_.size() < window) return;
  VectorXd times(static_cast<Index>(window));
  MatrixXd points(times.size(), system_.num_coordinates());
  for (Index k = 0; k < times.size(); ++k) {
    times[k] = frames_[static_cast<std::size_t>(k)].t;
    points.row(k) = frames_[static_cast<std::size_t>(k)].p.transpose();
  }
  const MatrixXd state = StateOfWindow(times, points);
  const auto row = [&](Index k) {
    const VectorXd flat = state.row(k).transpose();
    return MatrixXd(Eigen::Map<const MatrixXd>(flat.data(), system_.dim, system_.num_fingers()));
  };
  RegressionRows(system_, row(0), row(1), row(2), frames_[static_cast<std::size_t>(half_window_)].f,
                 terms_, X_, b_);
  regression_.Add(X_, b_);
}

}  // namespace springgrasp
