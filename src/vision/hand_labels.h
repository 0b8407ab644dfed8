// Whose cap is whose, told by how a hand is built. The paper orders the caps about the palm, which
// fails where the palm is taken for something else of skin's colour.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/fingers.h"
#include "vision/camera_model.h"
#include "vision/hand_model.h"

namespace springgrasp {

struct HandLabels {
  PerFinger<int> order = {};  // entry f: index of finger f's cap
  double rms = 0;             // m, of the caps off the model's tips in the posture that fits best
};

// All labellings of five caps (centres in W, m), the likeliest first: the model's tips in some
// postures of an open to a half closed hand laid over the caps, size free within 20 %, by the least
// squares of Umeyama (1991). Of ways that the hand may lie those with its back to the camera are
// out.
std::vector<HandLabels> RankLabels(const HandModel& model, const StereoCameras& cameras,
                                   const PerFinger<Eigen::Vector3d>& caps_W);

}  // namespace springgrasp
