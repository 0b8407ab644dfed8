// What may stand in the way of the eyes while a grasp is shown: plates before caps, clutter.
#pragma once

#include <string>

#include "sim/mjcf_part.h"
#include "sim/scene.h"

namespace springgrasp {

// Names of the mocap bodies. They start far below the floor; PlaceBody brings them in.
std::string OccluderName(int finger);
std::string ClutterName(int thing);

// Half width of a plate, m: it hides a cap from both eyes if it is kOccluderAhead before it.
inline constexpr double kOccluderHalf = 0.016, kOccluderAhead = 0.045;

// A grey plate for each finger of the demonstrator's occlusion; its z axis is its normal.
void AddOccluders(const Scene& scene, XmlElement* root);
// The demonstrator's clutter, in turn: a green plant, a yellow-green cup, a cyan box, a chequered
// box, a wooden block, a green book, a spotted ball, a striped jar; none wider than 0.2 m.
void AddClutter(const Scene& scene, XmlElement* root);

}  // namespace springgrasp
