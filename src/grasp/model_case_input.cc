#include "grasp/model_case_input.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"

namespace springgrasp {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

JsonKey::JsonKey(const nlohmann::json& value, std::string where)
    : value_(value), where_(std::move(where)) {}

bool JsonKey::Has(const char* key) const { return value_.is_object() && value_.contains(key); }

JsonKey JsonKey::operator[](const char* key) const {
  // The file's name is followed by a colon, deeper keys by dots.
  const char* separator = where_.find(": ") == std::string::npos ? ": " : ".";
  ThrowUnless(value_.is_object(), "{}: expected an object with the key '{}', found {}", where_, key,
              value_.type_name());
  ThrowUnless(value_.contains(key), "{}: key '{}' is missing", where_, key);
  return {value_.at(key), where_ + separator + key};
}

std::vector<JsonKey> JsonKey::Items() const {
  ThrowUnless(value_.is_array() && !value_.empty(), "{}: expected a list, found {}", where_,
              value_.is_array() ? "an empty one" : value_.type_name());
  std::vector<JsonKey> items;
  for (std::size_t i = 0; i < value_.size(); ++i) {
    items.emplace_back(value_[i], fmt::format("{}[{}]", where_, i));
  }
  return items;
}

double JsonKey::Number() const {
  ThrowUnless(value_.is_number(), "{}: expected a number, found {}", where_, value_.type_name());
  const double number = value_.get<double>();
  ThrowUnless(std::isfinite(number), "{}: the number is not finite", where_);
  return number;
}

double JsonKey::Number(double at_least) const {
  const double number = Number();
  ThrowUnless(number >= at_least, "{}: {} is below {}", where_, number, at_least);
  return number;
}

int JsonKey::Integer(int lower, int upper) const {
  ThrowUnless(value_.is_number_integer(), "{}: expected a whole number, found {}", where_,
              value_.dump());
  const auto number = value_.get<std::int64_t>();
  ThrowUnless(number >= lower && number <= upper, "{}: {} is not within {} to {}", where_, number,
              lower, upper);
  return static_cast<int>(number);
}

std::string JsonKey::Text() const {
  ThrowUnless(value_.is_string(), "{}: expected a text, found {}", where_, value_.type_name());
  return value_.get<std::string>();
}

VectorXd JsonKey::Vector(Index size) const {
  const std::vector<JsonKey> items = Items();
  const auto n = static_cast<Index>(items.size());
  ThrowUnless(size < 0 || n == size, "{}: {} numbers, expected {}", where_, n, size);
  VectorXd out(n);
  for (Index i = 0; i < n; ++i) out[i] = items[static_cast<std::size_t>(i)].Number();
  return out;
}

VectorXd JsonKey::Times() const {
  const VectorXd t = Vector(-1);
  ThrowUnless(t[0] >= 0, "{}: times start at {}, expected 0 or later", where_, t[0]);
  for (Index i = 1; i < t.size(); ++i) {
    ThrowUnless(t[i] > t[i - 1], "{}: times must increase; {} follows {}", where_, t[i], t[i - 1]);
  }
  return t;
}

MatrixXd JsonKey::Matrix(Index rows, Index columns) const {
  const std::vector<JsonKey> items = Items();
  const auto n = static_cast<Index>(items.size());
  ThrowUnless(rows < 0 || n == rows, "{}: {} rows, expected {}", where_, n, rows);
  MatrixXd out;
  for (Index i = 0; i < n; ++i) {
    const VectorXd row = items[static_cast<std::size_t>(i)].Vector(columns);
    if (i == 0) {
      columns = row.size();
      out.resize(n, columns);
    }
    out.row(i) = row.transpose();
  }
  return out;
}

MatrixXd JsonKey::Points(int dim, int num_fingers) const {
  return Matrix(num_fingers, dim).transpose();
}

namespace {

// The member of `options` that the text names.
template <typename T>
T Choose(const JsonKey& key, const std::vector<std::pair<const char*, T>>& options) {
  const std::string text = key.Text();
  std::string valid;
  for (const auto& [name, value] : options) {
    if (text == name) return value;
    valid += (valid.empty() ? "" : ", ") + std::string(name);
  }
  Fail("{}: unknown value '{}': valid are {}", key.where(), text, valid);
}

}  // namespace

SpringSystem ReadSpringSystem(const JsonKey& params, bool with_k) {
  constexpr int kMaxFingers = 100;
  const int N = params["N"].Integer(1, kMaxFingers);
  const int dim = params["dim"].Integer(2, 3);
  SpringSystem system = MakeSpringSystem(N, dim, 1.0);
  system.mass = params["m"].Vector(N);
  for (const JsonKey& mass : params["m"].Items()) mass.Number(1e-300);
  ThrowUnless(params["edges"].value().is_array(), "{}: expected a list", params["edges"].where());
  const std::size_t E = params["edges"].value().size();
  if (E > 0) {
    const std::vector<JsonKey> edges = params["edges"].Items();
    const auto size = static_cast<Index>(E);
    const VectorXd l = params["l"].Vector(size), d = params["d"].Vector(size);
    const VectorXd k = with_k ? params["k"].Vector(size) : VectorXd::Zero(size);
    for (std::size_t e = 0; e < E; ++e) {
      const std::vector<JsonKey> ends = edges[e].Items();
      ThrowUnless(ends.size() == 2, "{}: {} fingers, expected 2", edges[e].where(), ends.size());
      const int i = ends[0].Integer(0, N - 1), j = ends[1].Integer(0, N - 1);
      ThrowUnless(i != j, "{}: a spring must join two different fingers", edges[e].where());
      const auto at = static_cast<Index>(e);
      system.springs.push_back({i, j, k[at], l[at], d[at]});
    }
  }
  system.anchors = params["anchors"].Points(dim, N);
  const std::vector<JsonKey> involved = params["involved"].Items();
  ThrowUnless(static_cast<int>(involved.size()) == N, "{}: {} entries, expected {}",
              params["involved"].where(), involved.size(), N);
  for (std::size_t i = 0; i < involved.size(); ++i) {
    const JsonKey& c = involved[i];
    system.involved[i] = c.value().is_boolean() ? c.value().get<bool>() : c.Integer(0, 1) == 1;
  }
  system.rest_radius = params["L"].Vector(N);
  system.kc = params["kc"].Number();
  system.dc = params["dc"].Number();
  system.d0 = params["d0"].Number();
  system.eps_s = params["eps_s"].Number(1e-300);
  system.eps_c = params["eps_c"].Number(1e-300);
  system.r_max = params["Rmax"].IsNull() ? std::numeric_limits<double>::infinity()
                                         : params["Rmax"].Number(1e-300);
  system.damping = Choose<SpringDamping>(params["damping"], {{"axial", SpringDamping::kAxial},
                                                             {"vector", SpringDamping::kVector},
                                                             {"literal", SpringDamping::kLiteral}});
  system.ratio = Choose<ForceRatio>(
      params["ratio"], {{"paper", ForceRatio::kPaper}, {"reciprocal", ForceRatio::kReciprocal}});
  system.opening = Choose<OpeningDirection>(
      params["direction"],
      {{"surface", OpeningDirection::kSurface}, {"outward", OpeningDirection::kOutward}});
  if (params.Has("normals")) {
    system.normals = params["normals"].Points(dim, N);
    for (int i = 0; i < N; ++i) {
      const double norm = system.normals.col(i).norm();
      ThrowUnless(norm == 0 || std::abs(norm - 1) < 1e-6, "{}[{}]: not a unit vector",
                  params["normals"].where(), i);
    }
  }
  return system;
}

ForceProfile ReadForceProfile(const JsonKey& fcen) {
  constexpr double kTwoPi = 6.28318530717958647692;
  const std::string type = fcen["type"].Text();
  if (type == "constant") return ConstantForce(fcen["value"].Number());
  if (type == "minjerk") {
    const double T = fcen["T"].Number(1e-300);
    const double scale = fcen["gamma"].Number() * fcen["A"].Number() / (T * T);
    const auto f = [scale, T](double t) {
      const double s = t / T;
      return s > 0 && s < 1 ? -scale * s * (60 - s * (180 - 120 * s)) : 0.0;
    };
    return {f, {0, T}};
  }
  if (type == "sine") {
    const double amplitude = fcen["amplitude"].Number();
    const double period = fcen["period"].Number(1e-300);
    return {[=](double t) { return -amplitude * std::sin(kTwoPi * t / period); }, {}};
  }
  if (type == "table") {
    const VectorXd t = fcen["t"].Vector(-1);
    for (Index i = 1; i < t.size(); ++i) {
      ThrowUnless(t[i] > t[i - 1], "{}: times must increase; {} follows {}", fcen["t"].where(),
                  t[i], t[i - 1]);
    }
    return MakeForceProfile(t, fcen["f"].Vector(t.size()));
  }
  Fail("{}: unknown type '{}': valid are minjerk, constant, sine, table", fcen["type"].where(),
       type);
}

}  // namespace springgrasp
