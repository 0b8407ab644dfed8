// What is looked at after every step of a trial: contacts, collisions, slip, loss.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "experiment/contact_window.h"
#include "experiment/perform.h"
#include "experiment/phases.h"
#include "experiment/verdict.h"
#include "sim/robot_io.h"
#include "sim/simulation.h"

namespace springgrasp {

// Watches one object of a simulation in the hand of a robot. Events, largest slip and rotation go
// into `performance`, which also says the phase; all references must outlive it.
class TrialWatch {
 public:
  TrialWatch(const Simulation& simulation, const RobotIo& robot, int object,
             const TrialCriteria& criteria, Performance& performance);

  // The object rests: where it stands now is where it must stay until the first opposed contact.
  void Settled();
  // The grip has settled: slip counts from here.
  void Gripped();
  // The fingers let go: nothing is lost or slips from here.
  void Released() { released_ = true; }
  // After every simulation step of `dt` seconds.
  void Step(double dt);
  // The object is lost in the present phase (lift, hold, or later); ends the trial.
  void Dropped(const std::string& message);
  void Record(Outcome outcome, const std::string& message);

  bool over() const { return over_; }
  // Set once the object has slipped too far, and not been lost.
  const std::optional<TrialEvent>& slip() const { return slip_; }
  ContactAccumulator& window() { return window_; }
  HandLoad Load() const { return LoadOnBody(simulation_.contacts(), roles_, object_); }
  Pose ObjectPose() const;
  Pose ObjectInHand() const;

 private:
  void WatchTable();
  void WatchFirstContact(const Pose& X_WO, const Pose& X_WH, double dt);
  void WatchHeld(const Pose& X_WO, const Pose& X_WH, double dt);
  std::string Touching() const;

  const Simulation& simulation_;
  const RobotIo& robot_;
  const int object_;
  const TrialCriteria& criteria_;
  Performance& performance_;
  const std::vector<GeomRole> roles_;
  const double torsion_;  // m, torsional friction of the object
  ContactAccumulator window_, opposed_window_;
  Pose X_WO_start_, X_HO_grip_ = Pose::Identity();
  std::optional<TrialEvent> slip_;
  bool opposed_ = false, over_ = false, released_ = false;
  double untouched_ = 0;  // s
};

}  // namespace springgrasp
