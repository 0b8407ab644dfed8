// Strict reading of model cases: every access names file and key when something is wrong.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "grasp/spring_system.h"
#include "motion/central_force.h"

namespace springgrasp {

inline constexpr const char* kModelCaseFormat = "fingertip-springs-golden-1";

// A value in a JSON document together with its path ("case.json: params.kc"). Refers to the
// document. All readers throw Error for a wrong type or size or a number that is not finite.
class JsonKey {
 public:
  JsonKey(const nlohmann::json& value, std::string where);

  const std::string& where() const { return where_; }
  const nlohmann::json& value() const { return value_; }
  bool Has(const char* key) const;
  JsonKey operator[](const char* key) const;
  std::vector<JsonKey> Items() const;
  bool IsNull() const { return value_.is_null(); }

  double Number() const;
  double Number(double at_least) const;
  int Integer(int lower, int upper) const;
  std::string Text() const;
  // `size` -1: any but empty.
  Eigen::VectorXd Vector(Eigen::Index size) const;
  // Increasing numbers, at least one.
  Eigen::VectorXd Times() const;
  // Rows x columns from nested arrays; `columns` -1: those of the first row.
  Eigen::MatrixXd Matrix(Eigen::Index rows, Eigen::Index columns) const;
  // One array of `dim` numbers per finger, as a dim x N matrix.
  Eigen::MatrixXd Points(int dim, int num_fingers) const;

 private:
  const nlohmann::json& value_;
  std::string where_;
};

// `params` of spring cases; k is required if `with_k`.
SpringSystem ReadSpringSystem(const JsonKey& params, bool with_k);
// `params.fcen`: minjerk, constant, sine, table.
ForceProfile ReadForceProfile(const JsonKey& fcen);

}  // namespace springgrasp
