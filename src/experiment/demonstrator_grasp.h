// The posture in which a human hand holds an object of known shape: where a synthesised
// demonstration ends.
#pragma once

#include <Eigen/Core>
#include <string>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"
#include "experiment/demonstrator_hand.h"
#include "grasp/grasp_frame.h"

namespace springgrasp {

// Whether fingers of that type come from above, or level from the side. Throws Error for an unknown
// approach, or for a power grasp from above.
bool ComesFromAbove(const std::string& type, const std::string& approach);

// What varies between two people (or two tries).
struct GraspStyle {
  double height = 0;  // m, of the contacts above the object's middle
  double pitch = 0;   // rad, fingers up (positive) from the type's usual direction
  double roll = 0;    // rad, about the fingers' direction
  // usual: pinch and tripod from above, power and lateral from the side
  std::string approach = "usual";  // usual | above | side
};

struct HeldPosture {
  Pose X_OH = Pose::Identity();  // hand in the object frame
  Eigen::VectorXd q;             // rad
  PerFinger<bool> involved = {};
  double worst_gap = 0;          // m, |distance of tip centre to surface - tip radius|
  double worst_penetration = 0;  // m, of finger segments into the object
  double opposition_deg = 0;     // between the thumb's normal and the mean of the others
};

// Joint angles and hand pose by least squares: involved tip centres one tip radius outside the
// surface, thumb opposed to the other fingers, finger segments outside the object, otherwise as
// near as possible to the type's natural posture and direction (pinch and tripod from above with
// the palm towards -y of O, power and lateral level with the fingers towards -x, thumb up; pinch
// and tripod from the side as these).
HeldPosture SolveHeldPosture(const DemonstratorHand& hand, const std::string& type,
                             const Shape& shape, const GraspStyle& style = {});

}  // namespace springgrasp
