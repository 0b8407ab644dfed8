// Whether a scene's objects can be grasped where they stand, before any trial.
#pragma once

#include <map>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "kinematics/reach_map.h"
#include "sim/scene.h"

namespace springgrasp {

// A posture of torso and platform, by joint name, rad and m; what `Scene::start` takes.
using BasePosture = std::map<std::string, double>;

// What may move to bring an object into reach: the torso where the scene says `torso: free`, the
// platform where it is active.
struct ReachAids {
  bool torso = false, platform = false;
};
ReachAids AidsOf(const Scene& scene);

struct ObjectReach {
  std::string name;
  Eigen::Vector3d p_WO = Eigen::Vector3d::Zero();
  int side = 0, above = 0;         // directions of the hand (CountDirections)
  std::vector<BasePosture> moves;  // that bring it well into reach, least first; at most 3
};

struct ReachReport {
  ReachMapOptions options;
  std::vector<ReachMap> maps;        // from low to high
  std::vector<ObjectReach> objects;  // in the scene's order
  double table_height = 0;           // m
};

// Maps at three heights of the grasp centre above the table: 40, 90 and 140 mm. Moves are looked
// for where an object is reached in less than a quarter of the directions, both from the side and
// from above.
ReachReport ReportReach(const Scene& scene, const ReachAids& aids, const ReachMapOptions& options);

// Whether a robot in this posture touches neither itself nor the scene's table.
bool StandsClear(const Scene& scene, const BasePosture& base);

// Torso and platform postures that bring a place well into reach, least first; at most 3.
std::vector<BasePosture> MovesIntoReach(const Scene& scene, const ReachAids& aids,
                                        const Eigen::Vector3d& p_WO,
                                        const ReachMapOptions& options);

// Postures from which hand poses that hold an object are reached and can be lifted by `lift` (m);
// those from which most of 48 of them are come first, of equal ones the least; at most `most`.
std::vector<BasePosture> MovesToHold(const Scene& scene, const ReachAids& aids,
                                     const std::vector<Pose>& X_WH, double lift, std::size_t most);

std::string FormatReachReport(const ReachReport& report);
// From above, side and above by columns, heights by rows; BGR.
cv::Mat DrawReachReport(const ReachReport& report, const Scene& scene);

}  // namespace springgrasp
