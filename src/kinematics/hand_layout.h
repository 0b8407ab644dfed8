// Which joints a pneumatic hand has, in which order, and which valve drives each.
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace springgrasp {

inline constexpr int kNumValves = 8;
inline constexpr int kMaxHandJoints = 12;

// Names without the hand's prefix ("hand_r_"). Joints: palm, then j0 (proximal) and j1 (distal) of
// each finger 0..4, so that those of finger f are 1 + 2 f and 2 + 2 f, then what a variant adds.
struct HandLayout {
  std::vector<std::string_view> joints;
  std::array<std::string_view, kNumValves> valves;
  std::vector<int> valve_of_joint;
  int opposition = -1;  // joint that turns the thumb about the hand's long axis; -1: none
  int num_joints() const { return static_cast<int>(joints.size()); }
};

// 11 joints; ring finger and pinkie share the last valve.
const HandLayout& DocumentedHand();
// 12 joints on as many valves: the thumb's two joints share one, the opposition joint has its own.
const HandLayout& OppositionHand();

}  // namespace springgrasp
