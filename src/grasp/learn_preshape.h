// The preshape of a grasp: where the hand opens to before it closes, and how it comes back. All of
// it is read from the demonstration, nothing is fitted.
#pragma once

#include <cstddef>

#include "grasp/learn_fit.h"

namespace springgrasp {

// Step of the smoothed tips at which the hand is widest, of those where every involved finger that
// was observed had been measured within 0.06 s: a bridged gap may bulge.
std::size_t WidestInstant(const FitProblem& fit);

// Where f_cen < 0 must push the involved fingers so that they open as they did up to the step
// `widest`: the first principal component of their ways, less what the auxiliary springs alone
// leave of the start. From the contacts in H, m.
Fingertips Preshape(const FitProblem& fit, std::size_t widest);

// How these ways are bent, 1/m: the parabola through each one's path up to soon after the widest
// instant, parallel to its chord `opening` in the middle; `opening` becomes the tangent beside the
// contact. Straight for a finger that opens by less than 10 mm.
Fingertips OpeningBend(const FitProblem& fit, std::size_t widest, Fingertips& opening);

// How the involved fingers' ways back to their contacts are bent (spring_system.h), 1/m: the
// parabola through each one's path from where it is farthest on. Straight where that is less than
// 10 mm away.
Fingertips ClosingBend(const FitProblem& fit);

// How much later than the mean of the involved fingers each closes, s: judged by when it has half
// of its way back behind it. 0 for a finger that comes back less than 10 mm, or before the hand is
// widest.
PerFinger<double> ClosingLag(const FitProblem& fit);

}  // namespace springgrasp
