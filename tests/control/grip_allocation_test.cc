// A grip's control step takes no memory after its first.
#include <gtest/gtest.h>

#include <cstddef>

#include "control/grip_controller.h"
#include "control/toy_hand.h"

namespace {
long allocations = 0;
}  // namespace

// Eigen takes its memory from malloc, as new does. A sanitizer has a malloc of its own.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace springgrasp {
namespace {

constexpr double kDt = 0.002;

void ExpectNoneThroughAGrip(bool enclosing) {
  const KinematicTree hand = ToyHand();
  const PneumaticHandModel model(DocumentedHand());
  GripTask task;
  task.enclosing = enclosing;
  task.involved = {true, true, true, enclosing, enclosing};
  GripController controller(model, hand, {0, 1, 2, 3, 4}, task);
  RobotState state;
  state.hand_q = HandVector::Constant(11, 0.4);
  state.hand_qd = state.hand_bias = HandVector::Zero(11);
  HandTarget reference;
  reference.q = HandVector::Constant(11, 0.7);
  reference.qd = reference.qdd = HandVector::Zero(11);
  const auto run = [&](GripStage stage, double duration) {
    for (int i = 0; i < duration / kDt; ++i) {
      const ValveVector u = controller.Control(state, reference, stage, kDt);
      state.pressure += kDt / model.fill_time * (u - state.pressure);
      controller.SensedForce();
    }
  };
  run(GripStage::kFree, kDt);
  const long before = allocations;
  run(GripStage::kFree, 0.1);
  run(GripStage::kClosing, 0.5);
  run(GripStage::kPressing, 3);
  EXPECT_TRUE(controller.held());
  state.hand_q.array() += 0.1;  // slips: fingers close
  run(GripStage::kPressing, 0.5);
  EXPECT_EQ(allocations, before);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(GripAllocationTest, EigensMemoryIsCounted) {
  const long before = allocations;
  const Eigen::VectorXd some = Eigen::VectorXd::Random(100);
  EXPECT_GT(allocations, before) << some[0];
}
#endif

TEST(GripAllocationTest, AFingertipGripTakesNone) { ExpectNoneThroughAGrip(false); }
TEST(GripAllocationTest, AnEnclosingGripTakesNone) { ExpectNoneThroughAGrip(true); }

}  // namespace
}  // namespace springgrasp
