// Setting the object down: the hand's way from the lifted pose to a place on the table, and away.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "experiment/phases.h"
#include "kinematics/arm_ik.h"

namespace springgrasp {

struct PlaceRequest {
  Pose X_WO = Pose::Identity();        // the object where it is grasped
  Pose X_WO_place = Pose::Identity();  // and where it shall stand, turned alike
  std::vector<Pose> X_WH;              // the reach, which the hand leaves the object along
  double T = 1;                        // s, of its contact
  Eigen::VectorXd q_lifted;            // the arm where the way begins, rad
  double lift = 0.15;                  // m, above the grasp
  double dt = 0.005;                   // s
  TrialCriteria criteria;
};

struct PlacePlan {
  bool complete = false;
  std::string reason;                    // one line when not
  std::vector<Pose> X_WH;                // of the hand to the place, m
  std::vector<Eigen::VectorXd> arm;      // rad, same samples
  std::vector<Eigen::VectorXd> retreat;  // rad, from there back along the reach
};

// The way is a DMP (Eq. (10)-(13)) whose goal is the place: learned from a minimum-jerk arc that
// goes sideways before it goes down. The retreat is the end of the reach, backwards.
PlacePlan PlanPlace(const Arm& arm, const PlaceRequest& request);

}  // namespace springgrasp
