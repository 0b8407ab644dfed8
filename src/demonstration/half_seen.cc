#include "demonstration/half_seen.h"

#include <cstddef>

namespace springgrasp {

Demonstration WithoutHalfSeenTips(const Demonstration& demonstration) {
  constexpr double kHidden = 0.08;   // s
  constexpr std::size_t kLeast = 3;  // samples in a row
  Demonstration out = demonstration;
  const auto& samples = demonstration.samples;
  for (int i = 0; i < kNumFingers; ++i) {
    const auto seen = [&](std::size_t n) { return samples[n].p_WF[i].has_value(); };
    for (std::size_t first = 0; first < samples.size(); ++first) {
      if (!seen(first)) continue;
      std::size_t last = first;
      while (last + 1 < samples.size() && seen(last + 1)) ++last;
      // When it was seen before and after, or when the recording begins and ends.
      std::size_t before = first, after = last;
      while (before > 0 && (before == first || !seen(before))) --before;
      while (after + 1 < samples.size() && (after == last || !seen(after))) ++after;
      if (last - first + 1 >= kLeast) {
        if (samples[first].t - samples[before].t >= kHidden) out.samples[first].p_WF[i].reset();
        if (samples[after].t - samples[last].t >= kHidden) out.samples[last].p_WF[i].reset();
      }
      first = last;
    }
  }
  return out;
}

}  // namespace springgrasp
