#include <algorithm>
#include <nlopt.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include "base/random.h"
#include "kinematics/mapping_problem.h"

namespace springgrasp {

MappingResult MapHandByNlopt(const RobotHand& robot, const MappingTarget& target, int starts,
                             const Eigen::VectorXd& previous, const MappingOptions& options) {
  FastHand hand(robot);
  MappingProblem problem(robot, target, previous, options, hand);
  const int n = problem.num_valves();
  nlopt::opt solver(nlopt::LD_SLSQP, static_cast<unsigned>(n));
  const nlopt::vfunc objective = [](const std::vector<double>& x, std::vector<double>& gradient,
                                    void* context) {
    ValveAngles angles = ValveAngles::Zero();
    std::copy(x.begin(), x.end(), angles.data());
    auto& minimised = *static_cast<MappingProblem*>(context);
    const double cost = minimised.Cost(angles);
    if (!gradient.empty()) {
      const ValveAngles g = minimised.Gradient();
      for (std::size_t i = 0; i < gradient.size(); ++i) gradient[i] = 2 * g[static_cast<int>(i)];
    }
    return cost;
  };
  solver.set_min_objective(objective, &problem);
  const auto as_vector = [n](const ValveAngles& v) {
    return std::vector<double>(v.data(), v.data() + n);
  };
  solver.set_lower_bounds(as_vector(problem.lower));
  solver.set_upper_bounds(as_vector(problem.upper));
  solver.set_xtol_abs(3e-5);
  solver.set_ftol_rel(1e-12);
  solver.set_maxeval(500);
  std::optional<RandomEngine> engine;
  MappingSolution best;
  best.cost = std::numeric_limits<double>::infinity();
  for (int s = 0; s < starts; ++s) {
    std::vector<double> x = as_vector(problem.Start());
    if (s == 1) engine = MakeStream(0, 0, "mapping yardstick");
    for (int v = 0; v < n && s > 0; ++v) {
      x[v] = Uniform(*engine, problem.lower[v], problem.upper[v]);
    }
    double found = 0;
    try {
      solver.optimize(x, found);
    } catch (const std::runtime_error&) {
      // Round-off at the optimum: x is still the best point so far.
    }
    ValveAngles angles = ValveAngles::Zero();
    std::copy(x.begin(), x.end(), angles.data());
    const double cost = problem.Cost(angles);
    if (cost < best.cost) best = {angles, cost, problem.squared_tip_errors()};
  }
  return ResultOf(problem, best);
}

}  // namespace springgrasp
