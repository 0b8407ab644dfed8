// What moves the fingers in the place of the springs, to be compared with them. Hand pose, reach,
// believed object, force controller and verdict are those of the grasp by springs.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/fingers.h"
#include "experiment/robot_body.h"
#include "grasp/fingertip_motion.h"
#include "grasp/grasp.h"
#include "kinematics/contact_posture.h"

namespace springgrasp {

// The directions in which the joints of a hand move together most (Santello, Flanders, Soechting,
// "Postural hand synergies for tool use", J. Neuroscience 18, 1998).
struct PosturalSynergies {
  Eigen::VectorXd mean;   // rad
  Eigen::MatrixXd basis;  // joints x 2, orthonormal columns
  double explained = 0;   // part of the postures' variance
  Eigen::Vector2d low = Eigen::Vector2d::Zero(),
                  high = Eigen::Vector2d::Zero();  // coordinates that the postures take
};

// Principal components of the robot's joint angles through the grasps of `library` on their own
// objects, each mapped from the human hand by Eq. (14) with lambda = 1.
PosturalSynergies FindSynergies(const RobotBody& body, const std::vector<Grasp>& library);

struct BaselineRequest {
  std::string name;  // interpolation | playback | synergies
  // playback: the demonstrated tips in the human's H through the reach, even steps.
  std::vector<PerFinger<Eigen::Vector3d>> demonstrated;
  PosturalSynergies synergies;  // of the robot's hand
};

// Joint angles (rad) at the samples of `motion`, in the hand that the springs would have: `posture`
// says where the object lies in it and where its pads belong. `human`: the hand that demonstrated.
//   interpolation  straight from the open hand to the demonstrated joint angles, that is Eq. (14)
//                  without its position term, on the object of the demonstration
//   playback       Eq. (14) of the demonstrated tips about the object, with the springs' weights;
//                  an object of another size or shape changes nothing
//   synergies      straight in the plane of two synergies from what is next to the open hand to
//                  where the tips are nearest to the contacts on the new object
// Throws Error for another name.
std::vector<Eigen::VectorXd> PlanBaselineHand(const BaselineRequest& request, const RobotBody& body,
                                              const HumanHand& human, const Grasp& grasp,
                                              const FingertipMotion& motion,
                                              const ContactPosture& posture);

}  // namespace springgrasp
