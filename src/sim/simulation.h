// A model and its state. After Step(), positions, velocities, Jacobians and inertia all belong to
// time(); contacts() are those of the step that just ended.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/pose.h"
#include "sim/contacts.h"
#include "sim/mujoco_handles.h"

namespace springgrasp {

// All that the next step depends on; restoring it repeats the future to the bit.
struct Snapshot {
  double time = 0;
  std::vector<double> qpos, qvel, act, ctrl, qacc_warmstart, xfrc_applied, mocap_pos, mocap_quat;
};

struct Divergence {
  std::string warning;  // which engine warning, in words
  double time = 0;      // s
};

class Simulation {
 public:
  // Starts at the keyframe "start" if there is one. Throws Error for a null model.
  explicit Simulation(ModelPtr model);

  const mjModel& model() const { return *model_; }
  const mjData& data() const { return *data_; }
  mjData& mutable_data() { return *data_; }
  double time() const { return data_->time; }
  double timestep() const { return model_->opt.timestep; }

  void Reset();
  // Advances by `steps` time steps with the controls as set. Stops at the first engine warning,
  // non-finite number or speed beyond 1000 m/s; from then on diverged() says which, and Step() does
  // nothing until Reset() or Restore(). Never throws, never crashes.
  void Step(int steps = 1);
  // Recomputes everything that depends on positions and velocities (after placing by hand).
  void Forward();
  const std::optional<Divergence>& diverged() const { return divergence_; }

  // Contacts with force at the start of the last step; empty after Reset, Restore, Forward.
  const std::vector<ContactPoint>& contacts() const { return contacts_; }

  void SetControl(int actuator, double value);
  void SetControl(const std::string& actuator, double value);

  Snapshot TakeSnapshot() const;
  void Restore(const Snapshot& snapshot);

  // Kinematic placing; call Forward() when done. SetJoint: hinge or slide. PlaceBody: a mocap body
  // or one with a free joint (its velocity becomes zero). Throw Error for unknown names.
  void SetJoint(const std::string& joint, double position);
  void PlaceBody(const std::string& body, const Pose& X_WB);

  // A constant external force at the body's centre of mass in W (N), until changed.
  void ApplyForce(const std::string& body, const Eigen::Vector3d& f_W);

 private:
  bool Check();
  void FirstHalf();

  ModelPtr model_;
  DataPtr data_;
  std::optional<Divergence> divergence_;
  std::vector<ContactPoint> contacts_;
  // Positions as integrated, and as the engine left them after making quaternions unit.
  std::vector<double> raw_qpos_, unit_qpos_;
};

// Pose of a body's frame and velocity of its centre of mass, in W.
struct BodyState {
  Pose X_WB = Pose::Identity();
  Eigen::Vector3d p_WC = Eigen::Vector3d::Zero();  // centre of mass, m
  Eigen::Vector3d v_WC = Eigen::Vector3d::Zero();  // m/s
  Eigen::Vector3d w_WB = Eigen::Vector3d::Zero();  // rad/s
};
BodyState ReadBodyState(const mjModel& model, const mjData& data, int body);

}  // namespace springgrasp
