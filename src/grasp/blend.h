// Between two grasps: the paper's claim that all grasp types are instances of one parameterisation
// (section II, Eq. (5)), taken at its word. Every parameter of a grasp (k, rest lengths, gains,
// contacts, c(i), reach) runs from one grasp to the other, so there is a grasp at every place in
// between, and it changes continuously.
#pragma once

#include "base/shape.h"
#include "grasp/grasp.h"

namespace springgrasp {

// `grasp` as it meets an object: contacts, hand and reach moved to where GenerateMotion puts them
// on this shape for fingertips of this radius (m). Generating either gives the same motion.
Grasp CarriedTo(const Grasp& grasp, const Shape& shape, double tip_radius);

// The grasp at `s` from `from` (0) to `to` (1) on one object. A finger that takes part in only one
// of the two comes to it, or leaves it, by the share of its auxiliary spring and central force: the
// paper's c(i), which is 0 or 1 there, runs in between. Positive gains run by their logarithms,
// orientations by the shorter way, all else straight. The type is that of the nearer grasp. Throws
// Error if the two differ in dimension, ratio, profile or basis of the reach, or s is not in [0,
// 1].
Grasp BlendGrasps(const Grasp& from, const Grasp& to, double s, const Shape& shape,
                  double tip_radius);

}  // namespace springgrasp
