// Objects that stay in the hand without being grasped: lying on the palm, scooped onto the fingers,
// wedged between two of them. None passes for any type.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/files.h"
#include "experiment/robot_body.h"
#include "experiment/trial_watch.h"
#include "experiment/verdict.h"
#include "sim/model_index.h"
#include "sim/robot_io.h"
#include "sim/scene_builder.h"

namespace springgrasp {
namespace {

constexpr double kGravity = 9.81, kMass = 0.1;

// The open hand, held still, and one object on it. Gravity may point anywhere.
class OpenHand {
 public:
  explicit OpenHand(const std::string& shape) {
    scene_ = ReadScene(SourceFolder() + "/scenes/pinch_ball.yaml");
    scene_.table.position.y() = 4;  // out of the way
    SceneObject& object = scene_.objects[0];
    object.shape = ParseShape(shape);
    object.mass = kMass;
    object.on_ring = false;
    object.ring_height = 0;
    const Simulation posed(BuildModel(scene_));
    body_ = MakeRobotBody(posed);
    X_WH_ = RobotIo(posed.model(), "r").HandPose(posed);
  }

  const RobotHand& hand() const { return body_.hand; }
  // Tip of a straight finger and its knuckle, in H.
  Eigen::Vector3d Along(int finger, double part) const {
    std::vector<Pose> X_HB;
    ForwardKinematics(hand().tree, Eigen::VectorXd::Zero(hand().tree.num_joints()), X_HB);
    const RobotHand::Finger& f = hand().fingers[finger];
    const Eigen::Vector3d knuckle = X_HB[f.base].translation();
    return knuckle + part * (FramePose(hand().tree, X_HB, f.tip).translation() - knuckle);
  }

  // One second with the object at rest in `X_HO` at first and gravity along `down_H`; what the last
  // half of it shows of the contacts.
  ContactWindow Rest(const Pose& X_HO, const Eigen::Vector3d& down_H) {
    ModelPtr model = BuildModel(scene_);
    const Eigen::Vector3d g = kGravity * (X_WH_.linear() * down_H.normalized());
    std::copy_n(g.data(), 3, model->opt.gravity);
    Simulation simulation(std::move(model));
    const RobotIo robot(simulation.model(), "r");
    const ArmVector arm = robot.Read(simulation).arm_q;
    const HandVector fingers = HandVector::Zero(robot.layout().num_joints());
    simulation.PlaceBody("ball", X_WH_ * X_HO);
    const std::vector<GeomRole> roles = ClassifyGeoms(simulation.model());
    const int object = IdOf(simulation.model(), mjOBJ_BODY, "ball");
    ContactAccumulator window(roles, object);
    const auto pose = [&] {
      return ReadBodyState(simulation.model(), simulation.data(), object).X_WB;
    };
    const int steps = static_cast<int>(std::lround(1 / simulation.timestep()));
    for (int i = 0; i < steps; ++i) {
      robot.MoveArm(arm, ArmVector::Zero(), simulation);
      robot.MoveHand(fingers, HandVector::Zero(fingers.size()), simulation);
      simulation.Step();
      if (i < steps / 2) continue;
      window.Add(simulation.contacts(), pose(), robot.HandPose(simulation), 0.005,
                 simulation.timestep());
    }
    moved_ = (X_WH_.inverse() * pose()).translation() - X_HO.translation();
    EXPECT_FALSE(simulation.diverged());
    return window.Mean();
  }
  double moved() const { return moved_.norm(); }
  const Shape& shape() const { return *scene_.objects[0].shape; }

 private:
  Scene scene_;
  RobotBody body_;
  Pose X_WH_;
  Eigen::Vector3d moved_ = Eigen::Vector3d::Zero();
};

// Held, and yet no grasp of any type.
void ExpectHeldButNotGrasped(const OpenHand& hand, const ContactWindow& window) {
  EXPECT_LT(hand.moved(), 0.03);
  EXPECT_GT(window.total_normal, 0.5 * kMass * kGravity);
  EXPECT_FALSE(IsOpposed(window, {}));
  for (const char* type : {"pinch", "tripod", "power", "lateral"}) {
    const ContactCheck check = CheckContacts(type, window, hand.shape(), {});
    EXPECT_FALSE(check.ok) << type;
    EXPECT_FALSE(check.reason.empty()) << type;
  }
}

TEST(VerdictScenesTest, BalancingABoxOnThePalmIsNoGrasp) {
  OpenHand hand("box:0.05x0.05x0.02");
  const Eigen::Matrix3d R_HA = hand.hand().R_HA;
  Pose X_HO = MakePose(hand.hand().p_HPalm - 0.011 * R_HA.col(2), Eigen::Quaterniond(R_HA));
  ExpectHeldButNotGrasped(hand, hand.Rest(X_HO, R_HA.col(2)));
}

TEST(VerdictScenesTest, ScoopingAPlateWithTheFingersIsNoGrasp) {
  OpenHand hand("box:0.05x0.08x0.005");
  const Eigen::Matrix3d R_HA = hand.hand().R_HA;
  const Eigen::Vector3d middle =
      0.5 * (hand.Along(kMiddle, 0.6) + hand.Along(kRing, 0.6)) - 0.013 * R_HA.col(2);
  ExpectHeldButNotGrasped(hand, hand.Rest(MakePose(middle, Eigen::Quaterniond(R_HA)), R_HA.col(2)));
}

TEST(VerdictScenesTest, WedgingARodBetweenTwoFingersIsNoGrasp) {
  OpenHand hand("cylinder:0.03x0.04");
  const Eigen::Matrix3d R_HA = hand.hand().R_HA;
  const Eigen::Vector3d index = hand.Along(kIndex, 0.4), middle = hand.Along(kMiddle, 0.4);
  // The rod lies along the fingers in the groove between them: on capsules of 8 mm.
  const double apart = (index - middle).norm() / 2, reach = 0.008 + 0.015;
  ASSERT_LT(apart, reach);
  const double above = std::sqrt(reach * reach - apart * apart);
  const Eigen::Matrix3d along = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()).matrix();
  const Pose X_HO = MakePose(0.5 * (index + middle) - (above + 0.001) * R_HA.col(2),
                             Eigen::Quaterniond(R_HA * along));
  const ContactWindow window = hand.Rest(X_HO, R_HA.col(2));
  EXPECT_GT(window.normal[kIndex], 0.3);
  EXPECT_GT(window.normal[kMiddle], 0.3);
  ExpectHeldButNotGrasped(hand, window);
}

}  // namespace
}  // namespace springgrasp
