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

// A distance field of a mask and its slope at a pixel, bilinear; beyond the region, to its border
// too.
double DistanceAt(const HandMask& mask, const cv::Mat& field, const Eigen::Vector2d& pixel,
                  Eigen::Vector2d& slope) {
  const Eigen::Vector2d at = mask.ToMask(pixel);
  const double x = std::clamp(at.x(), 0.0, field.cols - 1.001);
  const double y = std::clamp(at.y(), 0.0, field.rows - 1.001);
  const int j = static_cast<int>(x), i = static_cast<int>(y);
  const double a = x - j, b = y - i;
  const float* top = field.ptr<float>(i) + j;
  const float* bottom = field.ptr<float>(std::min(i + 1, field.rows - 1)) + j;
  slope = {((1 - b) * (top[1] - top[0]) + b * (bottom[1] - bottom[0])) / mask.step,
           ((1 - a) * (bottom[0] - top[0]) + a * (bottom[1] - top[1])) / mask.step};
  const double inside =
      (1 - b) * ((1 - a) * top[0] + a * top[1]) + b * ((1 - a) * bottom[0] + a * bottom[1]);
  const Eigen::Vector2d beyond = mask.step * (at - Eigen::Vector2d(x, y));
  if (beyond.squaredNorm() > 0) slope += beyond.normalized();
  return inside + beyond.norm();
}

// Residual of a signed distance that saturates at `reach`: d / sqrt(1 + (d / reach)^2) / sigma.
double Saturate(double d, double reach, double sigma, double& slope) {
  const double ratio = d / reach, root = std::sqrt(1 + ratio * ratio);
  slope = 1 / (root * root * root * sigma);
  return d / (root * sigma);
}

}  // namespace

HandFitProblem::HandFitProblem(const HandModel& model, const StereoCameras& cameras,
                               const HandObservation& observation, const HandFields& fields,
                               const HandFit& last, const Pose& X_predicted, bool fit_scale,
                               bool first, const HandPoseOptions& options)
    : model_(model),
      cameras_(cameras),
      observation_(observation),
      last_(last),
      X_predicted_(X_predicted),
      fit_scale_(fit_scale),
      first_(first),
      options_(options),
      fields_(fields) {
  n_ = model.tree.num_joints();
  num_residuals_ = 3 * kNumFingers;
  for (const MaskField& field : fields_.masks) {
    if (field.mask == nullptr) continue;
    num_residuals_ += static_cast<int>(model.balls.size() + field.samples.size());
  }
  num_residuals_ +=
      2 + 1 + 6 + 2 * n_ + static_cast<int>(model.coupled.size() + model.neighbours.size()) + 3;
  node_motion_.assign(model.tree.nodes.size(), {});
  for (std::size_t b = 0; b < model.tree.nodes.size(); ++b) {
    for (int a = static_cast<int>(b); a >= 0; a = model.tree.nodes[a].parent) {
      if (model.tree.nodes[a].joint >= 0) node_motion_[b].push_back(a);
    }
  }
  q_predicted_ = last.q;
  scaled_ = model.tree;
  axis_W_.resize(scaled_.nodes.size());
  origin_W_.resize(scaled_.nodes.size());
  const auto balls = static_cast<Eigen::Index>(model.balls.size());
  p_W_.resize(model.balls.size());
  J_pixel_.resize(model.balls.size());
  for (Eigen::ArrayXf* array : {&u_, &v_, &radius_, &distance_}) array->resize(balls);
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
  for (std::size_t b = 0; b < scaled_.nodes.size(); ++b) {
    axis_W_[b] = fit.X_WH.linear() * (X_HB_[b].linear() * scaled_.nodes[b].axis);
    origin_W_[b] = fit.X_WH * X_HB_[b].translation();
  }
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
    for (int c = 0; c < 3 && J != nullptr; ++c) {
      AddRow(fit, frame.node, p_W, weight * Eigen::Vector3d::Unit(c), row + c, *J);
    }
  }
  for (std::size_t i = 0; i < model_.balls.size(); ++i) {
    p_W_[i] = Point(fit, model_.balls[i].node, model_.balls[i].p_B);
  }
  for (int v = 0; v < 2; ++v) {
    if (fields_.masks[v].mask == nullptr) continue;
    AddBalls(fit, v, row, r, J);
    row += static_cast<int>(model_.balls.size());
    AddOutline(fit, v, row, r, J);
    row += static_cast<int>(fields_.masks[v].samples.size());
  }
  AddSleeve(fit, row, r, J);
  row += 2;
  AddWrist(fit, row++, r, J);
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
      const bool seen = observation_.tip_W[model_.finger[j]].has_value();
      const double sigma = seen                  ? options_.joint_sigma
                           : model_.abduction[j] ? options_.unseen_aside_sigma
                                                 : options_.unseen_sigma;
      r[row] = (fit.q[j] - q_predicted_[j]) / sigma;
      if (J != nullptr) (*J)(row, 6 + j) = 1 / sigma;
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
  for (const auto& [a, b] : model_.neighbours) {
    r[row] = (fit.q[a] - fit.q[b]) / options_.neighbour_sigma;
    if (J != nullptr) {
      (*J)(row, 6 + a) = 1 / options_.neighbour_sigma;
      (*J)(row, 6 + b) = -1 / options_.neighbour_sigma;
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
  const double palm_sigma = first_ ? options_.first_palm_sigma : options_.palm_sigma;
  const Eigen::Vector3d forward = cameras_.left.X_WC.linear().col(2);
  const Eigen::Vector3d back = fit.X_WH.linear().col(2);
  r[row] = (1 - back.dot(forward)) / palm_sigma;
  if (J != nullptr) J->block<1, 3>(row, 3) = forward.transpose() * Cross(back) * Jl_ / palm_sigma;
}

void HandFitProblem::AddBalls(const HandFit& fit, int view, int row, Eigen::VectorXd& r,
                              Eigen::MatrixXd* J) {
  const CameraModel& camera = cameras_.view(view);
  const MaskField& field = fields_.masks[view];
  const ObjectDepth* object =
      observation_.object != nullptr ? &observation_.object->depth[view] : nullptr;
  for (std::size_t i = 0; i < model_.balls.size(); ++i, ++row) {
    const HandBall& ball = model_.balls[i];
    const auto pixel = Project(camera, p_W_[i], &J_pixel_[i]);
    const double depth = camera.X_WC.linear().col(2).dot(p_W_[i] - camera.X_WC.translation());
    u_[i] = pixel ? static_cast<float>(pixel->x()) : -1e4F;
    v_[i] = pixel ? static_cast<float>(pixel->y()) : -1e4F;
    radius_[i] = static_cast<float>(camera.fx * ball.radius * fit.scale / std::max(0.05, depth));
    if (!pixel || ball.forearm) continue;
    if (object != nullptr && object->At(*pixel) < depth) continue;  // hidden
    Eigen::Vector2d slope;
    const double d = DistanceAt(*field.mask, field.outside, *pixel, slope);
    double gain;
    r[row] = Saturate(d, options_.mask_reach_px, options_.ball_sigma_px, gain);
    if (J == nullptr || d <= 0) continue;
    AddRow(fit, ball.node, p_W_[i], gain * J_pixel_[i].transpose() * slope, row, *J);
  }
}

void HandFitProblem::AddOutline(const HandFit& fit, int view, int row, Eigen::VectorXd& r,
                                Eigen::MatrixXd* J) {
  const MaskField& field = fields_.masks[view];
  for (std::size_t k = 0; k < field.samples.size(); ++k, ++row) {
    const Eigen::Vector2f sample = field.samples[k].cast<float>();
    distance_ = ((u_ - sample.x()).square() + (v_ - sample.y()).square()).sqrt() - radius_;
    Eigen::Index nearest = 0;
    const double least = distance_.minCoeff(&nearest);
    const HandBall& ball = model_.balls[static_cast<std::size_t>(nearest)];
    // Where an object or a sleeve cuts the picture of the hand, the hand goes on behind it.
    if (least <= 0 && (field.cut[k] || ball.cut)) continue;
    double gain;
    r[row] = Saturate(least, options_.mask_reach_px, options_.skin_sigma_px, gain);
    if (J == nullptr) continue;
    const Eigen::Vector2d direction(u_[nearest] - sample.x(), v_[nearest] - sample.y());
    AddRow(fit, ball.node, p_W_[nearest],
           gain * J_pixel_[nearest].transpose() * direction.normalized(), row, *J);
  }
}

std::optional<HandFitProblem::Sleeve> HandFitProblem::SleeveIn(int view,
                                                               const Eigen::Vector3d& p_W) const {
  constexpr double kBorder = 12;  // px
  const CameraModel& camera = cameras_.view(view);
  const MaskField& field = fields_.masks[view];
  if (field.mask == nullptr) return std::nullopt;
  Eigen::Matrix<double, 2, 3> J_pixel;
  const auto pixel = Project(camera, p_W, &J_pixel);
  if (!pixel) return std::nullopt;
  // The picture's border cuts the mask as a sleeve does.
  if (pixel->x() < kBorder || pixel->y() < kBorder || pixel->x() > camera.width - 1 - kBorder ||
      pixel->y() > camera.height - 1 - kBorder) {
    return std::nullopt;
  }
  if (observation_.object != nullptr && observation_.object->depth[view].Covers(*pixel)) {
    return std::nullopt;
  }
  Eigen::Vector2d slope_out, slope_in;
  const double d = DistanceAt(*field.mask, field.outside, *pixel, slope_out) -
                   DistanceAt(*field.mask, field.inside, *pixel, slope_in);
  return Sleeve{d, J_pixel.transpose() * (slope_out - slope_in)};
}

void HandFitProblem::AddSleeve(const HandFit& fit, int row, Eigen::VectorXd& r,
                               Eigen::MatrixXd* J) {
  if (!model_.sleeve_x) return;
  constexpr double kReach = 20;  // px
  const Eigen::Vector3d p_W = fit.X_WH * Eigen::Vector3d(fit.scale * *model_.sleeve_x, 0, 0);
  for (int v = 0; v < 2; ++v) {
    const auto sleeve = SleeveIn(v, p_W);
    if (!sleeve) continue;
    double gain;
    r[row + v] = Saturate(sleeve->distance, kReach, options_.sleeve_sigma_px, gain);
    if (J != nullptr) AddRow(fit, 0, p_W, gain * sleeve->slope_W, row + v, *J);
  }
}

void HandFitProblem::AddWrist(const HandFit& fit, int row, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
  if (!fields_.wrist) return;
  const Pose& X_WC = cameras_.left.X_WC;
  const Eigen::Vector3d forward = X_WC.linear().col(2), p_WH = fit.X_WH.translation();
  double gain;
  r[row] = Saturate(forward.dot(p_WH - X_WC.translation()) - fields_.wrist->depth,
                    options_.wrist_depth_reach,
                    std::hypot(fields_.wrist->sigma, options_.wrist_depth_sigma), gain);
  if (J != nullptr) AddRow(fit, 0, p_WH, gain * forward, row, *J);
}

void HandFitProblem::AddRow(const HandFit& fit, int node, const Eigen::Vector3d& p_W,
                            const Eigen::Vector3d& slope_W, int row, Eigen::MatrixXd& J) const {
  const Eigen::Vector3d lever = p_W - fit.X_WH.translation();
  J.block<1, 3>(row, 0) = slope_W.transpose();
  J.block<1, 3>(row, 3) = lever.cross(slope_W).transpose() * Jl_;
  for (const int a : node_motion_[static_cast<std::size_t>(node)]) {
    const KinematicTree::Node& joint = scaled_.nodes[a];
    J(row, 6 + joint.joint) =
        joint.slide ? axis_W_[a].dot(slope_W) : axis_W_[a].cross(p_W - origin_W_[a]).dot(slope_W);
  }
  J(row, 6 + n_) = lever.dot(slope_W);  // all lengths from H grow with exp(log scale)
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
