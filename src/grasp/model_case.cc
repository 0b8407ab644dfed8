#include "grasp/model_case.h"

#include <Eigen/Core>
#include <Eigen/SVD>
#include <cmath>
#include <functional>
#include <limits>

#include "base/error.h"
#include "base/files.h"
#include "grasp/model_case_input.h"
#include "grasp/spring_estimation.h"
#include "grasp/spring_integrator.h"
#include "motion/central_force.h"
#include "motion/dmp.h"

namespace springgrasp {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Small enough for comparison at 1e-9 m (spring-model note, section 4).
constexpr double kStep = 5e-4;

Json VectorJson(const VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

// Rows of a matrix as nested arrays.
Json RowsJson(const MatrixXd& values) {
  Json out = Json::array();
  for (Index i = 0; i < values.rows(); ++i) out.push_back(VectorJson(values.row(i).transpose()));
  return out;
}

// Points (dim x N) as one array per finger.
Json PointsJson(const MatrixXd& points) { return RowsJson(points.transpose()); }

// A finger-major row as one array per finger.
Json FingersJson(const Eigen::RowVectorXd& row, int dim) {
  return PointsJson(Eigen::Map<const MatrixXd>(row.data(), dim, row.size() / dim));
}

Json EvaluateRhs(const JsonKey& model_case) {
  const SpringSystem system = ReadSpringSystem(model_case["params"], true);
  Json out = Json::array();
  SpringTerms terms;
  for (const JsonKey& state : model_case["expected"].Items()) {
    const MatrixXd p = state["p"].Points(system.dim, system.num_fingers());
    const MatrixXd v = state["v"].Points(system.dim, system.num_fingers());
    const double f = state["f"].Number();
    EvaluateSprings(system, p, v, f, terms);
    out.push_back({{"p", PointsJson(p)},
                   {"v", PointsJson(v)},
                   {"f", f},
                   {"x", PointsJson(terms.x)},
                   {"xdot", PointsJson(terms.xdot)},
                   {"xc", PointsJson(terms.xc)},
                   {"s", VectorJson(terms.s)},
                   {"u", PointsJson(terms.u)},
                   {"R", terms.R},
                   {"acc", PointsJson(terms.acc)}});
  }
  return out;
}

Json EvaluateTrajectory(const JsonKey& model_case) {
  const JsonKey params = model_case["params"];
  const SpringSystem system = ReadSpringSystem(params, true);
  const ForceProfile force = ReadForceProfile(params["fcen"]);
  const JsonKey initial = model_case["initial"];
  const MatrixXd p0 = initial["p"].Points(system.dim, system.num_fingers());
  const MatrixXd v0 = initial["v"].Points(system.dim, system.num_fingers());
  const VectorXd t = model_case["expected"]["t"].Times();
  // The start holds at t = 0, whether it is asked for or not.
  const bool from_zero = t[0] == 0;
  VectorXd times(t.size() + (from_zero ? 0 : 1));
  times[0] = 0;
  times.tail(t.size()) = t;
  const auto trajectory =
      IntegrateSprings(system, force, p0, v0, times, {.step = kStep, .tolerance = 1e-14});
  ThrowUnless(trajectory.has_value(), "{}: the springs run away with these parameters",
              model_case.where());
  Json p = Json::array(), v = Json::array();
  for (Index i = from_zero ? 0 : 1; i < times.size(); ++i) {
    p.push_back(FingersJson(trajectory->p.row(i), system.dim));
    v.push_back(FingersJson(trajectory->v.row(i), system.dim));
  }
  return {{"t", VectorJson(t)}, {"p", p}, {"v", v}};
}

Json EvaluateFcen(const JsonKey& model_case) {
  const JsonKey input = model_case["input"];
  MotionSamples motion;
  motion.t = input["t"].Times();
  motion.v = input["v"].Matrix(motion.t.size(), -1);
  motion.a = input["a"].Matrix(motion.t.size(), motion.v.cols());
  const CentralForce force = MakeCentralForce(motion, model_case["params"]["gamma"].Number());
  VectorXd f(motion.t.size());
  for (Index i = 0; i < f.size(); ++i) f[i] = EvaluateCentralForce(force, motion.t[i]);
  return {{"t_switch", force.t_switch}, {"f", VectorJson(f)}};
}

Dmp ReadBasis(const JsonKey& params) {
  Dmp dmp;
  dmp.K = params["K"].Number(1e-300);
  dmp.D = params["D"].Number();
  dmp.alpha = params["alpha"].Number(0);
  dmp.centers = params["centers"].Vector(-1);
  dmp.widths = params["widths"].Vector(dmp.centers.size());
  return dmp;
}

Json EvaluateDmpLearn(const JsonKey& model_case) {
  const JsonKey input = model_case["input"];
  Dmp dmp = ReadBasis(model_case["params"]);
  dmp.tau = input["tau"].Number(1e-300);
  MotionSamples samples;
  samples.t = input["t"].Times();
  samples.x = input["x"].Matrix(samples.t.size(), -1);
  samples.v = input["xd"].Matrix(samples.t.size(), samples.x.cols());
  samples.a = input["xdd"].Matrix(samples.t.size(), samples.x.cols());
  LearnDmpWeights(samples, dmp);
  return {{"weights", RowsJson(dmp.weights)}};
}

Json EvaluateDmpRollout(const JsonKey& model_case) {
  const JsonKey params = model_case["params"];
  Dmp dmp = ReadBasis(params);
  dmp.tau = params["tau"].Number(1e-300);
  dmp.x0 = params["x0"].Vector(-1);
  dmp.g = params["g"].Vector(dmp.x0.size());
  dmp.weights = params["weights"].Matrix(dmp.centers.size(), dmp.x0.size());
  const VectorXd v0 = params.Has("v0") ? params["v0"].Vector(dmp.x0.size()) : VectorXd();
  const MotionSamples motion = RolloutDmp(dmp, model_case["expected"]["t"].Times(), v0);
  return {{"t", VectorJson(motion.t)},
          {"x", RowsJson(motion.x)},
          {"v", RowsJson(motion.v)},
          {"a", RowsJson(motion.a)}};
}

Json EvaluateEstimation(const JsonKey& model_case) {
  const JsonKey params = model_case["params"];
  const JsonKey input = model_case["input"];
  const SpringSystem system = ReadSpringSystem(params, false);
  const ForceProfile force = ReadForceProfile(params["fcen"]);
  const VectorXd t = input["t"].Times();
  const auto frames = [&](const char* key) {
    const std::vector<JsonKey> items = input[key].Items();
    ThrowUnless(static_cast<Index>(items.size()) == t.size(), "{}: {} frames, expected {}",
                input[key].where(), items.size(), t.size());
    std::vector<MatrixXd> points;
    for (const JsonKey& item : items) {
      points.push_back(item.Points(system.dim, system.num_fingers()));
    }
    return points;
  };
  const std::vector<MatrixXd> p = frames("p"), v = frames("v"), a = frames("a");
  const Index n = system.num_coordinates();
  const auto E = static_cast<Index>(system.springs.size());
  MatrixXd X(n * t.size(), E);
  VectorXd b(n * t.size());
  SpringTerms terms;
  for (Index i = 0; i < t.size(); ++i) {
    const auto frame = static_cast<std::size_t>(i);
    RegressionRows(system, p[frame], v[frame], a[frame], force.f(t[i]), terms,
                   X.middleRows(n * i, n), b.segment(n * i, n));
  }
  const SpringRegression solved = SolveRegression(X, b, 1e-10);
  return {{"k", VectorJson(solved.k)},
          {"first_frame_rows_X", RowsJson(X.topRows(n))},
          {"first_frame_rhs", VectorJson(b.head(n))},
          {"singular_values", VectorJson(solved.singular_values)}};
}

}  // namespace

Json EvaluateModelCase(const Json& model_case, const std::string& name) {
  const JsonKey root(model_case, name);
  const std::string format = root["format"].Text();
  ThrowUnless(format == kModelCaseFormat, "{}: format is '{}', expected '{}'",
              root["format"].where(), format, kModelCaseFormat);
  const std::string kind = root["kind"].Text();
  if (kind == "rhs") return EvaluateRhs(root);
  if (kind == "trajectory") return EvaluateTrajectory(root);
  if (kind == "fcen") return EvaluateFcen(root);
  if (kind == "dmp_learn") return EvaluateDmpLearn(root);
  if (kind == "dmp_rollout") return EvaluateDmpRollout(root);
  if (kind == "k_estimation") return EvaluateEstimation(root);
  Fail(
      "{}: unknown kind '{}': valid are rhs, trajectory, fcen, dmp_learn, dmp_rollout, "
      "k_estimation",
      root["kind"].where(), kind);
}

Json ReadModelCase(const std::string& path) {
  const std::string text = ReadFile(path);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    // The library's own message starts with an identifier in brackets.
    const std::string what = error.what();
    const auto bracket = what.find("] ");
    Fail("{}: not valid JSON: {}", path,
         bracket == std::string::npos ? what : what.substr(bracket + 2));
  }
}

}  // namespace springgrasp
