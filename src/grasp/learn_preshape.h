// The preshape of a grasp: where the hand opens to before it closes.
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

}  // namespace springgrasp
