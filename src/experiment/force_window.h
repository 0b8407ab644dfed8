// Mean grip forces over a window of time, as asked for and as the robot feels them.
#pragma once

#include <algorithm>

#include "base/fingers.h"

namespace springgrasp {

class ForceWindow {
 public:
  void Clear() { *this = {}; }
  // Forces of one step, N.
  void Add(const PerFinger<double>& target, const PerFinger<double>& sensed) {
    ++count_;
    for (int f = 0; f < kNumFingers; ++f) {
      target_[f] += target[f];
      sensed_[f] += sensed[f];
    }
  }
  PerFinger<double> MeanTarget() const { return Mean(target_); }
  PerFinger<double> MeanSensed() const { return Mean(sensed_); }

 private:
  PerFinger<double> Mean(PerFinger<double> sum) const {
    for (double& n : sum) n /= std::max(1, count_);
    return sum;
  }

  int count_ = 0;
  PerFinger<double> target_{}, sensed_{};
};

}  // namespace springgrasp
