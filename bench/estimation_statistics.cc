// How well k is found from demonstrations that the model itself made, against the Cramer-Rao bound:
// k/kc about 0.3, 1 mm noise, 23 Hz, 1.5 s; k, p(0) and v(0) unknown, everything else known.
//   estimation_statistics [DRAWS]
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstdlib>
#include <string>

#include "grasp/spring_estimation.h"
#include "grasp/spring_sensitivity.h"
#include "grasp/spring_test_systems.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kNoise = 0.001;  // m

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Covariance of k that no unbiased estimator falls below: its block of noise^2 (J'J)^-1.
MatrixXd BoundOnK(const SpringObservation& o) {
  SpringParameters parameters;
  parameters.start = true;
  MatrixXd J;
  IntegrateWithSensitivities(o.system, o.force, parameters, GraspStart(o.system.dim),
                             MatrixXd::Zero(o.system.dim, 5), o.t, {}, J);
  const MatrixXd information = J.transpose() * J / (kNoise * kNoise);
  const auto E = static_cast<Index>(o.system.springs.size());
  return information.ldlt().solve(MatrixXd::Identity(J.cols(), J.cols())).topLeftCorner(E, E);
}

void Run(bool power, int dim, int draws) {
  SpringObservation clean;
  clean.system = GraspSystem(power, dim);
  clean.force = ReachForce(0.04, 0.01);
  clean.t = EvenTimes(1.5, 1.0 / 23);
  clean.p = IntegrateSprings(clean.system, MakeForceProfile(clean.force), GraspStart(dim),
                             MatrixXd::Zero(dim, 5), clean.t)
                ->p;
  VectorXd truth(static_cast<Index>(clean.system.springs.size()));
  for (Index e = 0; e < truth.size(); ++e) {
    truth[e] = clean.system.springs[static_cast<std::size_t>(e)].k;
  }
  const MatrixXd bound = BoundOnK(clean);
  const MatrixXd root = bound.llt().matrixL();
  RandomEngine bound_engine = MakeStream(1001, 0, "bound");
  std::vector<double> at_bound;
  for (int i = 0; i < 20000; ++i) {
    VectorXd z(truth.size());
    for (double& x : z) x = Normal(bound_engine);
    at_bound.push_back((root * z).norm() / truth.norm());
  }
  std::vector<double> fitted, svd;
  int inside = 0, free = 0, zero = 0, svd_inside = 0;
  for (int draw = 0; draw < draws; ++draw) {
    RandomEngine engine = MakeStream(1001, static_cast<std::uint64_t>(draw), "estimation");
    SpringObservation o = clean;
    for (double& x : o.p.reshaped()) x += kNoise * Normal(engine);
    const SpringEstimate estimate = EstimateSprings({o}, {.max_iterations = 100});
    fitted.push_back((estimate.k - truth).norm() / truth.norm());
    svd.push_back((estimate.linear.k - truth).norm() / truth.norm());
    for (Index e = 0; e < truth.size(); ++e) {
      svd_inside +=
          std::abs(estimate.linear.k[e] - truth[e]) < 1.96 * estimate.linear.standard_error[e];
      if (estimate.k[e] <= 0) {
        ++zero;
        continue;
      }
      ++free;
      inside += std::abs(estimate.k[e] - truth[e]) < 1.96 * estimate.standard_error[e];
    }
  }
  const double reference = Median(at_bound);
  fmt::print("{:<6} {}-D  {:>5} {:>8.3f} {:>8.3f} {:>6.2f} {:>8.1f} {:>6} {:>8.3f} {:>8.1f}\n",
             power ? "power" : "pinch", dim, draws, Median(fitted), reference,
             Median(fitted) / reference, 100.0 * inside / free, zero, Median(svd),
             100.0 * svd_inside / (free + zero));
  std::fflush(stdout);
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) {
  const int draws = argc > 1 ? std::atoi(argv[1]) : 200;
  fmt::print("median relative error of k; share of 95 % intervals that hold the truth\n");
  fmt::print("grasp       draws   fitted    bound  ratio     % in  at 0   by SVD     % in\n");
  for (const int dim : {2, 3}) {
    for (const bool power : {true, false}) springgrasp::Run(power, dim, draws);
  }
}
