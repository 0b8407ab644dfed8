// Closed form of the inverse kinematics of an arm with a spherical shoulder, a hinge for an elbow
// and a spherical wrist. A hand pose leaves such an arm one freedom, the swivel of the elbow about
// the line from shoulder to wrist; the swivels that the joint ranges allow are found as intervals
// [Shimizu08]. A pose without any interval cannot be reached.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "base/pose.h"
#include "kinematics/arm_ik.h"

namespace springgrasp {

using SevenJoints = Eigen::Matrix<double, 7, 1>;

// Three hinges through one point, each square to the next: its rotation R(q) = R1 R2 R3 is known by
// five numbers that are linear in R.
struct SphericalJoint {
  std::array<Eigen::Vector3d, 3> axis;  // at q = 0, in W
  double offset = 0;                    // rad: the middle angle at which the outer axes are one
};

// An arm at q = 0 of its seven joints, all others as in Arm::q. In W.
struct ArmGeometry {
  SphericalJoint shoulder, wrist;
  Eigen::Vector3d elbow_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d p_WS = Eigen::Vector3d::Zero();  // shoulder centre
  Eigen::Vector3d p_SE = Eigen::Vector3d::Zero();  // from there to a point of the elbow's axis
  Eigen::Vector3d p_EC = Eigen::Vector3d::Zero();  // from that to the wrist centre
  Eigen::Vector3d p_HC = Eigen::Vector3d::Zero();  // wrist centre in the hand's frame
  Eigen::Matrix3d R_WH = Eigen::Matrix3d::Identity();
  SevenJoints lower, upper;  // rad
  // Swivel is 0 where the elbow is lowest while the wrist lies along `ahead` from the shoulder, and
  // is carried to other directions by the shortest turn: without a jump all over the space before
  // the robot.
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitY(), side = -Eigen::Vector3d::UnitZ();
  double bend = 1;  // sign that makes `side` the elbow's
};

// Absent: the arm is not of that kind (or torso joints move with it).
std::optional<ArmGeometry> GeometryOf(const Arm& arm);

// Swivels that one branch allows.
struct SwivelInterval {
  int elbow = 1, shoulder = 1, wrist = 1;  // signs that tell the eight branches apart
  double from = 0, to = 0;                 // rad; from < to, to - from <= 2 pi
  bool SameBranch(const SwivelInterval& b) const {
    return elbow == b.elbow && shoulder == b.shoulder && wrist == b.wrist;
  }
};

// All solutions for one hand pose. Reusing the value allocates nothing new.
class ArmSolutions {
 public:
  // `margin`: rad, kept from the joint ranges.
  void Solve(const ArmGeometry& geometry, const Pose& X_WH, double margin = 0);

  const std::vector<SwivelInterval>& intervals() const { return intervals_; }
  // Whether the elbow angle of a branch lies in its range; else the branch has no joints here.
  bool Has(const SwivelInterval& branch) const { return FamilyOf(branch).valid; }
  // Joint angles at a swivel of a branch (inside or outside of its interval).
  SevenJoints JointsAt(const SwivelInterval& branch, double swivel) const;
  // Branch and swivel of a posture that has the solved hand pose (nearly); the interval is empty.
  // Absent if no branch has its elbow angle.
  std::optional<std::pair<SwivelInterval, double>> SwivelOf(const SevenJoints& q) const;
  // Height of the elbow at a swivel: -1 lowest, 1 highest (of all swivels, 0 for a straight arm).
  double ElbowHeight(const SwivelInterval& branch, double swivel) const;

 private:
  // x1, y1: sine and cosine of the first angle, w: of the middle, x3, y3: of the last, each as
  // (cos swivel, sin swivel, 1) times a column.
  using Linear = Eigen::Matrix<double, 5, 3>;
  struct Family {  // of one elbow angle
    bool valid = false;
    double elbow = 0;
    Eigen::Matrix3d M = Eigen::Matrix3d::Identity();  // shoulder at swivel 0
    Linear shoulder, wrist;
    Eigen::Vector3d height = Eigen::Vector3d::Zero();
  };
  bool Inside(const SevenJoints& q) const;
  const Family& FamilyOf(const SwivelInterval& b) const { return families_[b.elbow > 0 ? 0 : 1]; }
  void AddIntervals(int elbow);

  const ArmGeometry* geometry_ = nullptr;
  double margin_ = 0;
  std::array<Family, 2> families_;
  Eigen::Vector3d ahead_ = Eigen::Vector3d::UnitX();  // from shoulder to wrist centre
  std::vector<double> roots_;
  std::vector<SwivelInterval> intervals_;
};

}  // namespace springgrasp
