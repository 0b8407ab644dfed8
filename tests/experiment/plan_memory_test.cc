#include "experiment/plan_memory.h"

#include <gtest/gtest.h>

#include "experiment/observation_key.h"

namespace springgrasp {
namespace {

TEST(PlanMemoryTest, PlansOncePerKeyAndPosture) {
  PlanMemory memory;
  int made = 0;
  const auto make = [&] {
    PlanResult plan;
    plan.reason = std::to_string(++made);
    return plan;
  };
  EXPECT_EQ(memory.Get("a", 0, make).reason, "1");
  EXPECT_EQ(memory.Get("a", 0, make).reason, "1");
  EXPECT_EQ(memory.Get("a", 1, make).reason, "2");
  EXPECT_EQ(memory.Get("a", 0, make).reason, "1");
  EXPECT_EQ(memory.Get("b", 0, make).reason, "3");
  EXPECT_EQ(memory.Get("a", 0, make).reason, "4");
}

TEST(PlanMemoryTest, WithoutAKeyNothingIsKept) {
  PlanMemory memory;
  int made = 0;
  const auto make = [&] {
    ++made;
    return PlanResult();
  };
  memory.Get("", 0, make);
  memory.Get("", 0, make);
  EXPECT_EQ(made, 2);
}

TEST(PlanKeyTest, LeavesOutPhysicsAndDrivesAlone) {
  TrialSpec spec;
  spec.scene_text = "objects: [{name: ball, mass: 0.1}]\nphysics: {timestep: 0.002}\n";
  const auto with = [&](const char* text) {
    TrialSpec other = spec;
    other.scene_text = text;
    return PlanKey(other);
  };
  EXPECT_EQ(PlanKey(spec), with("objects: [{name: ball, mass: 0.1}]\nphysics: {timestep: 0.001}\n"
                                "pneumatics: {friction: 0.01}\n"));
  EXPECT_NE(PlanKey(spec),
            with("objects: [{name: ball, mass: 0.2}]\nphysics: {timestep: 0.002}\n"));
  TrialSpec other = spec;
  other.baseline = "playback";
  EXPECT_NE(PlanKey(spec), PlanKey(other));
  other = spec;
  other.repetition = 1;
  EXPECT_NE(PlanKey(spec), PlanKey(other));
}

}  // namespace
}  // namespace springgrasp
