// A model file loaded for a test, with access by name.
#pragma once

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <memory>
#include <string>

namespace springgrasp {

inline std::string ModelPath(const std::string& name) {
  return std::string(SPRINGGRASP_SOURCE_DIR) + "/models/" + name;
}

inline Eigen::Vector3d ToVector(const YAML::Node& numbers) {
  return {numbers[0].as<double>(), numbers[1].as<double>(), numbers[2].as<double>()};
}

class ModelFile {
 public:
  explicit ModelFile(const std::string& path) {
    char error[1000] = "";
    model_.reset(mj_loadXML(path.c_str(), nullptr, error, sizeof(error)));
    if (model_ == nullptr) throw std::runtime_error(path + ": " + error);
    data_.reset(mj_makeData(model_.get()));
    mj_forward(model_.get(), data_.get());
  }

  mjModel* m() const { return model_.get(); }
  mjData* d() const { return data_.get(); }

  int Id(mjtObj type, const std::string& name) const {
    const int id = mj_name2id(m(), type, name.c_str());
    if (id < 0) throw std::runtime_error("the model has no object named " + name);
    return id;
  }
  std::string Name(mjtObj type, int id) const {
    const char* name = mj_id2name(m(), type, id);
    return name == nullptr ? "" : name;
  }
  double& Angle(const std::string& joint) {
    return d()->qpos[m()->jnt_qposadr[Id(mjOBJ_JOINT, joint)]];
  }
  double UpperLimit(const std::string& joint) const {
    return m()->jnt_range[2 * Id(mjOBJ_JOINT, joint) + 1];
  }
  Eigen::Vector3d Body(const std::string& name) const {
    return Eigen::Map<const Eigen::Vector3d>(d()->xpos + 3 * Id(mjOBJ_BODY, name));
  }
  Eigen::Vector3d Site(const std::string& name) const {
    return Eigen::Map<const Eigen::Vector3d>(d()->site_xpos + 3 * Id(mjOBJ_SITE, name));
  }
  Eigen::Matrix3d SiteAxes(const std::string& name) const {
    return Axes(d()->site_xmat, Id(mjOBJ_SITE, name));
  }
  Eigen::Matrix3d BodyAxes(const std::string& name) const {
    return Axes(d()->xmat, Id(mjOBJ_BODY, name));
  }
  Eigen::Matrix3d CameraAxes(const std::string& name) const {
    return Axes(d()->cam_xmat, Id(mjOBJ_CAMERA, name));
  }
  Eigen::Matrix3d GeomAxes(const std::string& name) const {
    return Axes(d()->geom_xmat, Id(mjOBJ_GEOM, name));
  }
  Eigen::Vector3d Geom(const std::string& name) const {
    return Eigen::Map<const Eigen::Vector3d>(d()->geom_xpos + 3 * Id(mjOBJ_GEOM, name));
  }

  int NumWarnings() const {
    int count = 0;
    for (int i = 0; i < mjNWARNING; ++i) count += d()->warning[i].number;
    return count;
  }

 private:
  static Eigen::Matrix3d Axes(const double* matrices, int id) {
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(matrices + 9 * id);
  }

  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

}  // namespace springgrasp
