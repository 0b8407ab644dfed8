// Where in a demonstration the reach lies: its beginning, its end, and the contact.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace springgrasp {

// Indices into even samples.
struct ReachSegment {
  int begin = 0;              // first 5 % of peak speed (0: cut in mid-movement or already moving)
  int peak = 0;               // largest hand speed of the reach
  int stop = 0;               // hand at rest after the reach
  int contact = 0;            // hand at rest and involved fingers settled: end of the movement
  bool cut_at_begin = false;  // still moving at the first or last sample
  bool cut_at_end = false;
};

// `speed` of the hand, m/s, and `span` between thumb and the other involved fingers, m, at even
// steps `dt`, smoothed; `speed_noise` (m/s) is the speed that measurement noise alone makes, and
// `span_noise` (m) its deviation in the span. Later movements (lifting, letting go, retreating)
// are left out: the reach is the movement before the fingers first stay closed.
ReachSegment FindReach(const std::vector<double>& speed, const std::vector<double>& span, double dt,
                       double speed_noise, double span_noise);

}  // namespace springgrasp
