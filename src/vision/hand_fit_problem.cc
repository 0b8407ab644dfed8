#include "vision/hand_fit_problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "kinematics/levenberg_marquardt.h"

namespace springgrasp {
namespace {

constexpr double kUnbounded = 1e6;

Eigen::Matrix3d Cross(const Eigen::Vector3d& w) {
  Eigen::Matrix3d W;
  W << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return W;
}

// Left Jacobian of the exponential: d Exp(w) p = -[Exp(w) p]x J_l(w) dw.
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& w) {
  const double a = w.norm();
  const Eigen::Matrix3d W = Cross(w);
  if (a < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6;
  return Eigen::Matrix3d::Identity() + (1 - std::cos(a)) / (a * a) * W +
         (a - std::sin(a)) / (a * a * a) * W * W;
}

// Distance to the mask and its slope at a pixel, bilinear; beyond the region, to its border too.
double OutsideDistance(const MaskField& field, const Eigen::Vector2d& pixel,
                       Eigen::Vector2d& slope) {
  const Eigen::Vector2d at = field.mask->ToMask(pixel);
  const double x = std::clamp(at.x(), 0.0, field.outside.cols - 1.001);
  const double y = std::clamp(at.y(), 0.0, field.outside.rows - 1.001);
  const int j = static_cast<int>(x), i = static_cast<int>(y);
  const double a = x - j, b = y - i;
  const float* top = field.outside.ptr<float>(i) + j;
  const float* bottom = field.outside.ptr<float>(std::min(i + 1, field.outside.rows - 1)) + j;
  const double step = field.mask->step;
  slope = {((1 - b) * (top[1] - top[0]) + b * (bottom[1] - bottom[0])) / step,
           ((1 - a) * (bottom[0] - top[0]) + a * (bottom[1] - top[1])) / step};
  const double inside =
      (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
  const Eigen::Vector2d beyond = step * (at - Eigen::Vector2d(x, y));
  if (beyond.squaredNorm() > 0) slope += beyond.normalized();
  return inside + beyond.norm();
}

// Residual of a signed distance that saturates at `reach`: d / sqrt(1 + (d / reach)^2) / sigma.
double Saturate(double d, double reach, double sigma, double& slope) {
  const double ratio = d / reach, root = std::sqrt(1 + ratio * ratio);
  slope = 1 / (root * root * root * sigma);
  return d / (root * sigma);
}

void MarkCuts(const ObjectDepth* object, MaskField& field) {
  field.cut.assign(field.samples.size(), false);
  if (object == nullptr) return;
  const double step = 1.5 * field.mask->step;
  for (std::size_t k = 0; k < field.samples.size(); ++k) {
    for (const Eigen::Vector2d& side : {Eigen::Vector2d(step, 0), Eigen::Vector2d(-step, 0),
                                        Eigen::Vector2d(0, step), Eigen::Vector2d(0, -step)}) {
      if (object->Covers(field.samples[k] + side)) field.cut[k] = true;
    }
  }
}

}  // namespace

MaskField MakeField(const HandMask& mask, int wanted, const Eigen::Vector2d& middle,
                    double reach_px) {
  MaskField field;
  field.mask = &mask;
  cv::Mat inverse;
  cv::bitwise_not(mask.mask, inverse);
  cv::distanceTransform(inverse, field.outside, cv::DIST_L2, 3);
  field.outside *= mask.step;
  int total = 0;
  const auto visit = [&](auto&& keep) {
    for (int i = 0; i < mask.mask.rows; ++i) {
      const std::uint8_t* row = mask.mask.ptr(i);
      for (int j = 0; j < mask.mask.cols; ++j) {
        if (row[j] == 0) continue;
        // On the outline, but not where the region cuts the mask.
        if (i == 0 || j == 0 || i + 1 == mask.mask.rows || j + 1 == mask.mask.cols) continue;
        if (row[j - 1] != 0 && row[j + 1] != 0 && mask.mask.at<std::uint8_t>(i - 1, j) != 0 &&
            mask.mask.at<std::uint8_t>(i + 1, j) != 0) {
          continue;
        }
        const Eigen::Vector2d pixel = mask.ToPixel(Eigen::Vector2d(j, i));
        if ((pixel - middle).norm() < reach_px) keep(pixel);
      }
    }
  };
  visit([&](const Eigen::Vector2d&) { ++total; });
  const int stride = std::max(1, total / std::max(1, wanted));
  int index = 0;
  visit([&](const Eigen::Vector2d& pixel) {
    if (index++ % stride == 0 && static_cast<int>(field.samples.size()) < wanted) {
      field.samples.push_back(pixel);
    }
  });
  return field;
}

HandFitProblem::HandFitProblem(const HandModel& model, const StereoCameras& cameras,
                               const HandObservation& observation, const HandFit& last,
                               const Pose& X_predicted, bool fit_scale, bool first,
                               const HandPoseOptions& options)
    : model_(model),
      cameras_(cameras),
      observation_(observation),
      last_(last),
      X_predicted_(X_predicted),
      fit_scale_(fit_scale),
      first_(first),
      options_(options) {
  n_ = model.tree.num_joints();
  Eigen::Vector3d middle_W = Eigen::Vector3d::Zero();
  int tips = 0;
  for (const auto& tip : observation.tip_W) {
    if (tip) middle_W += *tip, ++tips;
  }
  if (tips > 0) middle_W /= tips;
  num_residuals_ = 3 * kNumFingers;
  for (int v = 0; v < 2; ++v) {
    if (observation.masks[v] == nullptr || observation.masks[v]->mask.empty() || tips == 0)
      continue;
    const auto middle = Project(cameras.view(v), middle_W);
    if (!middle) continue;
    const double depth =
        cameras.view(v).X_WC.linear().col(2).dot(middle_W - cameras.view(v).X_WC.translation());
    fields_[v] = MakeField(*observation.masks[v], options.mask_samples, *middle,
                           cameras.view(v).fx * 0.2 / std::max(0.1, depth));
    MarkCuts(observation.object != nullptr ? &observation.object->depth[v] : nullptr, fields_[v]);
    num_residuals_ += static_cast<int>(model.balls.size() + fields_[v].samples.size());
  }
  num_residuals_ += 6 + 2 * n_ + static_cast<int>(model.coupled.size()) + 3;
  node_motion_.assign(model.tree.nodes.size(), {});
  for (std::size_t b = 0; b < model.tree.nodes.size(); ++b) {
    for (int a = static_cast<int>(b); a >= 0; a = model.tree.nodes[a].parent) {
      if (model.tree.nodes[a].joint >= 0) node_motion_[b].push_back(a);
    }
  }
  scaled_ = model.tree;
}

HandFit HandFitProblem::Result(const Eigen::VectorXd& x) const {
  HandFit fit;
  fit.X_WH.translation() = x.head<3>();
  fit.X_WH.linear() = ExpRotation(x.segment<3>(3)).toRotationMatrix() * R_start_;
  fit.q = x.segment(6, n_);
  fit.scale = std::exp(x[6 + n_]);
  return fit;
}

void HandFitProblem::Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
  const HandFit fit = Result(x);
  for (std::size_t b = 0; b < scaled_.nodes.size(); ++b) {
    scaled_.nodes[b].X_PB.translation() = fit.scale * model_.tree.nodes[b].X_PB.translation();
  }
  ForwardKinematics(scaled_, fit.q, X_HB_);
  Jl_ = LeftJacobian(x.segment<3>(3));
  r.setZero();
  if (J != nullptr) J->setZero();
  int row = 0;
  // Fingertips.
  for (int f = 0; f < kNumFingers; ++f, row += 3) {
    if (!observation_.tip_W[f]) continue;
    const KinematicTree::Frame& frame = model_.tree.frames[model_.tip[f]];
    const double weight =
        std::sqrt(std::max(0.05, observation_.confidence[f])) / options_.tip_sigma;
    const Eigen::Vector3d p_W = Point(fit, frame.node, frame.X_BF.translation());
    r.segment<3>(row) = weight * (p_W - *observation_.tip_W[f]);
    if (J != nullptr) {
      PointJacobian(fit, frame.node, p_W);
      J->middleRows<3>(row) = weight * J_point_;
    }
  }
  // Balls and mask.
  const std::size_t num_balls = model_.balls.size();
  p_W_.resize(num_balls);
  for (std::size_t i = 0; i < num_balls; ++i) {
    p_W_[i] = Point(fit, model_.balls[i].node, model_.balls[i].p_B);
  }
  for (int v = 0; v < 2; ++v) {
    if (fields_[v].mask == nullptr) continue;
    const CameraModel& camera = cameras_.view(v);
    const ObjectDepth* object =
        observation_.object != nullptr ? &observation_.object->depth[v] : nullptr;
    pixel_.resize(num_balls);
    J_pixel_.resize(num_balls);
    radius_.resize(num_balls);
    for (std::size_t i = 0; i < num_balls; ++i) {
      const auto pixel = Project(camera, p_W_[i], &J_pixel_[i]);
      pixel_[i] = pixel.value_or(Eigen::Vector2d(-1e4, -1e4));
      const double depth = camera.X_WC.linear().col(2).dot(p_W_[i] - camera.X_WC.translation());
      radius_[i] = camera.fx * model_.balls[i].radius * fit.scale / std::max(0.05, depth);
      const int at = row + static_cast<int>(i);
      if (!pixel || model_.balls[i].forearm) continue;
      if (object != nullptr && object->At(*pixel) < depth) continue;  // hidden
      Eigen::Vector2d slope;
      const double d = OutsideDistance(fields_[v], pixel_[i], slope);
      double gain;
      r[at] = Saturate(d, options_.mask_reach_px, options_.ball_sigma_px, gain);
      if (J != nullptr && d > 0) {
        PointJacobian(fit, model_.balls[i].node, p_W_[i]);
        J->row(at) = gain * slope.transpose() * J_pixel_[i] * J_point_;
      }
    }
    row += static_cast<int>(num_balls);
    for (std::size_t k = 0; k < fields_[v].samples.size(); ++k) {
      const Eigen::Vector2d& sample = fields_[v].samples[k];
      std::size_t nearest = 0;
      double least = 1e9;
      for (std::size_t i = 0; i < num_balls; ++i) {
        const double d = (pixel_[i] - sample).norm() - radius_[i];
        if (d < least) least = d, nearest = i;
      }
      // Where an object or a sleeve cuts the picture of the hand, the hand goes on behind it.
      if (least > 0 || !(fields_[v].cut[k] || model_.balls[nearest].cut)) {
        double gain;
        r[row] = Saturate(least, options_.mask_reach_px, options_.skin_sigma_px, gain);
        if (J != nullptr) {
          PointJacobian(fit, model_.balls[nearest].node, p_W_[nearest]);
          const Eigen::Vector2d direction = (pixel_[nearest] - sample).normalized();
          J->row(row) = gain * direction.transpose() * J_pixel_[nearest] * J_point_;
        }
      }
      ++row;
    }
  }
  // Motion.
  if (!first_) {
    const Eigen::Vector3d turn = LogRotation(
        Eigen::Quaterniond(Eigen::Matrix3d(fit.X_WH.linear() * X_predicted_.linear().transpose())));
    r.segment<3>(row) = (x.head<3>() - X_predicted_.translation()) / options_.pose_sigma;
    r.segment<3>(row + 3) = turn / options_.turn_sigma;
    if (J != nullptr) {
      J->block<3, 3>(row, 0).diagonal().setConstant(1 / options_.pose_sigma);
      J->block<3, 3>(row + 3, 3).diagonal().setConstant(1 / options_.turn_sigma);
    }
  }
  row += 6;
  for (int j = 0; j < n_; ++j, row += 2) {
    if (!first_) {
      r[row] = (fit.q[j] - last_.q[j]) / options_.joint_sigma;
      if (J != nullptr) (*J)(row, 6 + j) = 1 / options_.joint_sigma;
    }
    r[row + 1] = (fit.q[j] - model_.rest[j]) / model_.rest_sigma[j];
    if (J != nullptr) (*J)(row + 1, 6 + j) = 1 / model_.rest_sigma[j];
  }
  constexpr double kCouplingSigma = 0.2;  // rad
  for (const auto& [middle, end] : model_.coupled) {
    r[row] = (fit.q[end] - 2.0 / 3 * fit.q[middle]) / kCouplingSigma;
    if (J != nullptr) {
      (*J)(row, 6 + end) = 1 / kCouplingSigma;
      (*J)(row, 6 + middle) = -2.0 / 3 / kCouplingSigma;
    }
    ++row;
  }
  // While it is free the scale also stays near that of the model, an adult's.
  constexpr double kScaleSigma = 0.04;
  const double tie = first_ ? 1e3 : fit_scale_ ? 0.005 : 1e-6;
  r[row] = (x[6 + n_] - std::log(last_.scale)) / tie;
  if (J != nullptr) (*J)(row, 6 + n_) = 1 / tie;
  ++row;
  if (first_ || fit_scale_) {
    r[row] = x[6 + n_] / kScaleSigma;
    if (J != nullptr) (*J)(row, 6 + n_) = 1 / kScaleSigma;
  }
  ++row;
  if (first_) {
    constexpr double kPalmSigma = 0.35;  // of 1 - cosine: 50 degrees
    const Eigen::Vector3d forward = cameras_.left.X_WC.linear().col(2);
    const Eigen::Vector3d back = fit.X_WH.linear().col(2);
    r[row] = (1 - back.dot(forward)) / kPalmSigma;
    if (J != nullptr) {
      J->block<1, 3>(row, 3) = forward.transpose() * Cross(back) * Jl_ / kPalmSigma;
    }
  }
}

void HandFitProblem::PointJacobian(const HandFit& fit, int node, const Eigen::Vector3d& p_W) {
  J_point_.setZero(3, num_variables());
  J_point_.leftCols<3>().setIdentity();
  const Eigen::Vector3d lever = p_W - fit.X_WH.translation();
  J_point_.middleCols<3>(3) = -Cross(lever) * Jl_;
  for (int a : node_motion_[node]) {
    const KinematicTree::Node& joint = model_.tree.nodes[a];
    const Eigen::Vector3d axis_W = fit.X_WH.linear() * (X_HB_[a].linear() * joint.axis);
    J_point_.col(6 + joint.joint) =
        joint.slide ? axis_W : axis_W.cross(p_W - fit.X_WH * X_HB_[a].translation());
  }
  J_point_.col(6 + n_) = lever;  // all lengths from H grow with exp(log scale)
}

HandFit Solve(HandFitProblem& fit, const HandModel& model, const HandFit& start, int iterations) {
  const int n = model.tree.num_joints();
  fit.SetStart(start);
  LeastSquaresProblem problem;
  problem.num_residuals = fit.num_residuals();
  problem.lower.setConstant(fit.num_variables(), -kUnbounded);
  problem.upper.setConstant(fit.num_variables(), kUnbounded);
  problem.lower.segment(6, n) = model.tree.lower;
  problem.upper.segment(6, n) = model.tree.upper;
  problem.lower[6 + n] = std::log(0.7);
  problem.upper[6 + n] = std::log(1.4);
  problem.evaluate = [&](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    fit.Evaluate(x, r, J);
  };
  LevenbergMarquardtOptions options;
  options.max_iterations = iterations;
  options.step_tolerance = 1e-5;
  const auto solution = MinimizeLeastSquares(problem, fit.Variables(start), options);
  HandFit result = fit.Result(solution.x);
  result.X_WH.linear() = Eigen::Quaterniond(result.X_WH.linear()).normalized().toRotationMatrix();
  result.cost = solution.cost;
  return result;
}

}  // namespace springgrasp
