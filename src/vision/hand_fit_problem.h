// The least-squares problem of hand_pose.h, shared by its sources only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "vision/hand_pose.h"
#include "vision/wrist_depth.h"

namespace springgrasp {

// A mask with what the fit asks of it.
struct MaskField {
  const HandMask* mask = nullptr;
  cv::Mat outside;                       // CV_32F, px of the picture to the nearest mask entry
  cv::Mat inside;                        // the same to the nearest entry that is not mask
  std::vector<Eigen::Vector2d> samples;  // px, of the mask's outline
  std::vector<bool> cut;  // of a sample: the outline may be the object's, not the hand's
};

// `wanted` samples of the outline not farther than `reach_px` from `middle`.
MaskField MakeField(const HandMask& mask, int wanted, const Eigen::Vector2d& middle,
                    double reach_px);

// What one frame's pictures ask, shared by all its fits.
struct HandFields {
  std::array<MaskField, 2> masks;  // left, right; mask null where nothing was seen
  std::optional<WristDepth> wrist;
};
HandFields MakeFields(const StereoCameras& cameras, const HandObservation& observation,
                      const HandPoseOptions& options);

// Variables: position of H (m), rotation vector applied from the left to R_start, joints, log
// scale. Residuals, in this order:
//   tips          3 per finger    (tip - seen) / sigma
//   balls         1 per view      distance outside the mask
//   outline       1 per view      signed distance from the outline of the balls
//   sleeve        1 per view      where the bare forearm ends, signed distance from the mask's edge
//   wrist         1               depth of the origin of H
//   motion        6               deviation from the predicted pose
//   joints        2 n             deviation from the last and from the resting posture
//   couplings     1 each          DIP - 2/3 PIP; difference of neighbouring fingers
//   scale         2               deviation from the last one and from the model's
//   palm          1               back of the hand faces away from the cameras
class HandFitProblem {
 public:
  HandFitProblem(const HandModel& model, const StereoCameras& cameras,
                 const HandObservation& observation, const HandFields& fields, const HandFit& last,
                 const Pose& X_predicted, bool fit_scale, bool first,
                 const HandPoseOptions& options);

  int num_variables() const { return 7 + n_; }
  int num_residuals() const { return num_residuals_; }

  Eigen::VectorXd Variables(const HandFit& fit) const {
    Eigen::VectorXd x(num_variables());
    x << fit.X_WH.translation(), Eigen::Vector3d::Zero(), fit.q, std::log(fit.scale);
    return x;
  }

  // Where the joints should be now; without it, where they were.
  void SetPredictedJoints(const Eigen::VectorXd& q) { q_predicted_ = q; }
  void SetStart(const HandFit& fit) { R_start_ = fit.X_WH.linear(); }

  HandFit Result(const Eigen::VectorXd& x) const;
  void Evaluate(const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J);

 private:
  Eigen::Vector3d Point(const HandFit& fit, int node, const Eigen::Vector3d& p_B) const {
    return fit.X_WH * (X_HB_[node] * (fit.scale * p_B));
  }

  // Row of J for a residual whose slope over the point p_W of a node is `slope_W`.
  void AddRow(const HandFit& fit, int node, const Eigen::Vector3d& p_W,
              const Eigen::Vector3d& slope_W, int row, Eigen::MatrixXd& J) const;
  void AddBalls(const HandFit& fit, int view, int row, Eigen::VectorXd& r, Eigen::MatrixXd* J);
  void AddOutline(const HandFit& fit, int view, int row, Eigen::VectorXd& r, Eigen::MatrixXd* J);
  void AddSleeve(const HandFit& fit, int row, Eigen::VectorXd& r, Eigen::MatrixXd* J);
  void AddWrist(const HandFit& fit, int row, Eigen::VectorXd& r, Eigen::MatrixXd* J);
  // Of the point p_W on the forearm's axis: signed distance off the mask's edge, px, and its slope.
  struct Sleeve {
    double distance;
    Eigen::Vector3d slope_W;
  };
  std::optional<Sleeve> SleeveIn(int view, const Eigen::Vector3d& p_W) const;

  const HandModel& model_;
  const StereoCameras& cameras_;
  const HandObservation& observation_;
  const HandFit& last_;
  Pose X_predicted_;
  Eigen::VectorXd q_predicted_;
  bool fit_scale_, first_;
  const HandPoseOptions& options_;
  int n_ = 0, num_residuals_ = 0;
  Eigen::Matrix3d R_start_ = Eigen::Matrix3d::Identity();
  const HandFields& fields_;
  std::vector<std::vector<int>> node_motion_;  // moving ancestors of each node
  KinematicTree scaled_;
  std::vector<Pose> X_HB_;
  Eigen::Matrix3d Jl_ = Eigen::Matrix3d::Identity();
  std::vector<Eigen::Vector3d> axis_W_, origin_W_;  // of the nodes' joints
  // Of the balls, the last three in the view at hand.
  std::vector<Eigen::Vector3d> p_W_;
  std::vector<Eigen::Matrix<double, 2, 3>> J_pixel_;
  Eigen::ArrayXf u_, v_, radius_, distance_;
};

// Levenberg-Marquardt from `start`; with no iterations it only gives the cost there.
HandFit Solve(HandFitProblem& fit, const HandModel& model, const HandFit& start, int iterations);

}  // namespace springgrasp
