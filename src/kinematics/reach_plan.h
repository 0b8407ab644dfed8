// Choosing what a grasp leaves free so that the arm can do it, and the arm's path.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "base/shape.h"
#include "kinematics/arm_body.h"
#include "kinematics/arm_ik.h"
#include "kinematics/robot_hand.h"

namespace springgrasp {

struct ReachPlan;

// Something fixed beside the table that the hand must keep off, such as what the object stands on.
struct Obstacle {
  Shape shape;
  Pose X_WS = Pose::Identity();
};

struct ReachRequest {
  Shape shape;
  Pose X_WO = Pose::Identity();  // believed object pose
  Pose X_HO = Pose::Identity();  // object in the robot's hand at contact
  Pose X_HC = Pose::Identity();  // see ContactFrame: tilts are about its x
  bool tilt_free = true;         // fingertip grasps: tilt about the contact line
  bool tilt_far = true;          // ... beyond max_tilt, and slide, where nothing else is reached
  double table_height = 0;       // m, world
  double table_edge = -1e9;      // m, W's y where the table begins; nearer, nothing is hit
  std::vector<Obstacle> obstacles;
  double dt = 0.005;                    // s
  double T = 1;                         // s, contact
  std::vector<Eigen::VectorXd> q_hand;  // hand joints at the path's samples, rad
  // Where the arm stands before (arm.joints' values). If the path begins at that hand pose, so does
  // the joint path; absent: the joint path begins in any posture.
  std::optional<Eigen::VectorXd> q_start;
  // Fingers that touch the object; palm and all others stay `spare_clearance` (m) off it at
  // contact, however the hand is turned about it. 0: not looked at.
  PerFinger<bool> involved = {};
  double spare_clearance = 0;
  // What the arm could hit of its own robot; null: not looked at.
  const ArmBody* body = nullptr;
  // The hand's path for an object posed at X_WO * X_OF (F: the free motion of the grasp about the
  // object, identity: as demonstrated). Its last poses must be X_WO * X_OF * X_HO^-1.
  std::function<std::vector<Pose>(const Pose& X_OF)> path;
  // Whether the object leaves that way free.
  std::function<bool(const std::vector<Pose>& X_WH)> clear;
  // What else the arm has to be able to do after the lift; empty: it is, else why not. May be null.
  std::function<std::string(const ReachPlan& plan)> refusal;
};

struct ReachOptions {
  double yaw_step = 0.17453292519943295;  // rad, 10 degrees
  double max_tilt = 0.3490658503988659;   // rad, 20 degrees
  // Only where nothing within max_tilt can be reached; the contacts stay as good. Then they may
  // slide up an upright object too; last, the hand may come from anywhere.
  double last_resort_tilt = 1.0471975511965976;  // rad, 60 degrees
  double any_tilt = 2.6179938779914944;          // rad, 150 degrees
  double slide_step = 0;                         // m, 0: contacts do not slide
  double clearance = 0.010;                      // m, of hand and forearm above the table
  double least_clearance = 0.002;                // m, a goal nearer to the table is not taken
  double lift = 0.15;                            // m
  double shake = 0.020;                          // m, along each axis
  double shake_frequency = 2;                    // Hz
  double shake_duration = 1;                     // s, per axis
  double lift_duration = 1.5;                    // s
  int path_candidates = 12;                      // how many goals get a whole path
  double max_joint_speed = 4;                    // rad/s
  // Where the arm cannot follow the hand's way from its start, it joins it by this part of T:
  // before the fingers, widest at 60 to 75 % of a human reach, begin to close.
  double latest_join = 0.55;
};

struct ReachPlan {
  bool reachable = false;
  std::string reason;                  // one line when not reachable
  Pose X_OF = Pose::Identity();        // the choice ...
  double yaw = 0, tilt = 0, roll = 0;  // ... by its angles, rad
  double slide = 0;                    // m, of the contacts along O's z
  std::vector<Pose> X_WH;              // hand path with via height, at dt
  double join = 0;                     // of T: before, the arm comes straight from its start
  std::vector<Eigen::VectorXd> arm;    // joint angles, rad, same samples
  std::vector<Eigen::VectorXd> lift;   // from the end of the reach straight up, at dt
  std::array<std::vector<Eigen::VectorXd>, 3> shake;  // about the lifted pose, along W's axes
  double limit_margin = 0;        // smallest over the path, 0..1 (see LimitMargin)
  double table_clearance = 0;     // m, smallest of hand and forearm over the path
  double self_clearance = 0;      // m, smallest of arm and rest of the robot, up to 0.05
  double via_raise = 0;           // m, added in the middle of the path
  int candidates = 0, goals = 0;  // tried, and reached at the goal
  // Hand poses of the widest search that hold the object clear of the table, reached or not.
  std::vector<Pose> holds;
};

// Motions F of the hand about O that leave the contacts as good as they are: sphere: turns about
// the vertical and rolls about G's z; cylinder: turns about its axis; box: half turns about z
// (quarter turns if square); each with tilts about the contact line: within max_tilt where
// `tilt_free`, for spheres within last_resort_tilt. Where a hand may tilt, the contacts may also
// slide along z by multiples of slide_step, to below the upper end. The demonstrated one (identity)
// is first.
struct FreeMotion {
  Pose X_OF = Pose::Identity();
  double yaw = 0, tilt = 0, roll = 0;  // rad
  double slide = 0;                    // m
};
std::vector<FreeMotion> FreeMotions(const ReachRequest& request, const ReachOptions& options = {});

// Evaluates all candidates at the goal (reached, lifted pose reached, limits, clearance), then
// plans whole paths for the best until one succeeds. Deterministic.
ReachPlan PlanReach(const Arm& arm, const RobotHand& hand, const ReachRequest& request,
                    const ReachOptions& options = {});

// Hand poses raised in the middle so that the hand (capsules at q_hand) stays `clearance` above
// the table, beyond its edge: z is lifted by raise * bump(t), 0 at the start and from sample `last`
// on. Returns the raise, m.
double RaisePath(const RobotHand& hand, const std::vector<Eigen::VectorXd>& q_hand,
                 double table_height, double table_edge, double clearance, int last,
                 std::vector<Pose>& X_WH);

// Height of the lowest point of the hand above the table (only what is beyond its edge), m.
double HandAboveTable(const RobotHand& hand, const Pose& X_WH, const Eigen::VectorXd& q_hand,
                      double table_height, double table_edge);

// Height of the lowest point of forearm and wrist above the table, m; joint values of the arm.
double ForearmAboveTable(const Arm& arm, const Eigen::VectorXd& q, double table_height,
                         double table_edge);

}  // namespace springgrasp
