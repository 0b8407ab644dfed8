// Interval of a success rate.
#pragma once

namespace springgrasp {

struct RateInterval {
  double lower = 0, upper = 1;
};

// Wilson score interval of `successes` of `n` at 95 % (z = 1.96); [0, 1] for n = 0.
RateInterval WilsonInterval(int successes, int n);

}  // namespace springgrasp
