// Smoothing of noisy recordings without delay, and their derivatives.
//
// SmoothCurve is the tool for anything: a penalised spline (quintic B-splines on even knots, third
// differences penalised; Eilers and Marx 1996) that takes uneven samples and gaps as they are and
// has exact derivatives. Its penalty is chosen so that on even data it passes frequencies like a
// zero-phase Butterworth filter of order 3: gain 1 / (1 + (f / cutoff)^6).
// FiltFilt is the plain alternative for even samples.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "motion/motion_samples.h"

namespace springgrasp {

// A smooth function of time, n coordinates.
struct SmoothCurve {
  double t0 = 0, spacing = 1;    // s, first knot and distance of knots
  Eigen::MatrixXd coefficients;  // quintic B-splines x n
};

// Fits x (samples x n) at increasing times t. `cutoff` in Hz. Rows with a NaN are left out: gaps
// are bridged by the curve of least jerk. `weights` (per sample, relative; all 1 if empty). Throws
// Error for fewer than 4 usable samples.
SmoothCurve FitSmoothCurve(const Eigen::VectorXd& t, const Eigen::MatrixXd& x, double cutoff,
                           const Eigen::VectorXd& weights = {});
// Values, velocities and accelerations at times within the fitted span (clamped to it).
MotionSamples EvaluateSmoothCurve(const SmoothCurve& curve, const Eigen::VectorXd& times);

// Fit and evaluation at `times` in one call.
MotionSamples SmoothSamples(const Eigen::VectorXd& t, const Eigen::MatrixXd& x, double cutoff,
                            const Eigen::VectorXd& times);

// Standard deviation of the noise of x (all coordinates pooled), from what a cubic through the
// neighbours (two on either side) misses, by the median: robust to gaps and outliers. Needs 5
// samples; 0 with fewer.
double EstimateNoise(const Eigen::VectorXd& t, const Eigen::MatrixXd& x);

// Cutoff in Hz for fingertip data with noise of deviation `noise` (m) at `rate` (Hz): 6, 5, 4 Hz at
// 0.5, 1, 2 mm at 23 Hz, higher where more samples average the noise out, and never above a third
// of the rate.
double ChooseCutoff(double noise, double rate);

// Second-order Butterworth low-pass run forwards and backwards (zero phase) over even samples
// `dt` apart, ends padded by point reflection and the filter started at rest there. The cutoff is
// that of one pass, 0 < cutoff < 0.5 / dt.
Eigen::MatrixXd FiltFilt(const Eigen::MatrixXd& x, double dt, double cutoff);

// Even samples `dt` apart of a point with noise `noise` (m), smoothed with ChooseCutoff. `rate`
// (Hz) of the measurement, if x was interpolated from it; 1 / dt if 0.
std::vector<Eigen::Vector3d> SmoothEvenly(const std::vector<Eigen::Vector3d>& x, double dt,
                                          double noise, double rate = 0);

// Velocities and accelerations of smooth data by local cubics over five neighbours: exact for
// cubics, uneven samples allowed. Needs 5 samples.
MotionSamples DifferentiateSamples(const Eigen::VectorXd& t, const Eigen::MatrixXd& x);

}  // namespace springgrasp
