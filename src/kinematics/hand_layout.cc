#include "kinematics/hand_layout.h"

namespace springgrasp {

const HandLayout& DocumentedHand() {
  static const HandLayout layout = {
      {"palm", "thumb_j0", "thumb_j1", "index_j0", "index_j1", "middle_j0", "middle_j1", "ring_j0",
       "ring_j1", "pinkie_j0", "pinkie_j1"},
      {"palm", "thumb_proximal", "thumb_distal", "index_proximal", "index_distal",
       "middle_proximal", "middle_distal", "ring_pinkie"},
      {0, 1, 2, 3, 4, 5, 6, 7, 7, 7, 7}};
  return layout;
}

const HandLayout& OppositionHand() {
  static const HandLayout layout = [] {
    HandLayout hand = DocumentedHand();
    hand.opposition = hand.num_joints();
    hand.joints.push_back("thumb_opposition");
    hand.valves[1] = "thumb_opposition";
    hand.valves[2] = "thumb_flexion";
    hand.valve_of_joint = {0, 2, 2, 3, 4, 5, 6, 7, 7, 7, 7, 1};
    return hand;
  }();
  return layout;
}

}  // namespace springgrasp
