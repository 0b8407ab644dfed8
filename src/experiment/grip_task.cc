#include "experiment/grip_task.h"

#include <fmt/format.h>

#include <algorithm>

#include "control/grip.h"

namespace springgrasp {
namespace {

// Of max_finger_force, for all fingers of a power grasp together: the thumb bears what they press
// and the load (tuned with experiments/grip, seeds 1 and 11).
constexpr double kEnclosingShare = 0.65;

// Against the surface that each planned pad touches, in H; in a grip of two along its axis, which
// is where their forces must balance.
PerFinger<Eigen::Vector3d> PushesOf(const GraspPlan& plan) {
  PerFinger<Eigen::Vector3d> pushes = NoDirections();
  if (std::ranges::count(plan.involved, true) <= 2) return pushes;
  for (int f = 0; f < kNumFingers; ++f) {
    if (plan.involved[f]) pushes[f] = -plan.n_HC[f];
  }
  return pushes;
}

}  // namespace

GripTask GripTaskOf(const GraspPlan& plan, const RobotHand& hand, const PerformOptions& options) {
  const GripOptions& grip = options.grip;
  GripTask task;
  task.enclosing = plan.type == "power";
  task.involved = plan.involved;
  // The index withstands along its joints' axes.
  if (plan.type == "lateral") task.push_H = -hand.R_HA.col(1);
  if (!task.enclosing && !task.push_H) task.pushes_H = PushesOf(plan);
  // The thumb of an enclosing hand bears what all others press, and the load.
  task.max_force = (task.enclosing ? kEnclosingShare : 1) * options.max_finger_force;
  task.force = std::max(
      task.enclosing ? grip.min_enclosing_force
      : task.push_H  ? grip.min_key_force
                     : grip.min_force,
      GripForceFor(plan.mass, plan.friction, grip.acceleration, grip.safety, task.max_force));
  return task;
}

PneumaticHandModel BelievedHand(const HandLayout& layout, const PerformOptions& options) {
  const PneumaticHandModel model(layout);
  if (options.pneumatics.model_error == 0) return model;
  RandomEngine engine = options.actuation;
  return WithErrors(model, options.pneumatics.model_error, engine);
}

PerFinger<int> TipFrames(const KinematicTree& hand) {
  PerFinger<int> frames;
  for (int f = 0; f < kNumFingers; ++f) {
    frames[f] = hand.FrameIndex(fmt::format("hand_r_{}_tip", kFingerNames[f]));
  }
  return frames;
}

}  // namespace springgrasp
