#include "kinematics/arm_body.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "sim/arm_body_of.h"
#include "test_arm.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

Vector3d AnyPoint(RandomEngine& engine) {
  return {Uniform(engine, -1, 1), Uniform(engine, -1, 1), Uniform(engine, -1, 1)};
}

TEST(ArmBodyTest, SegmentDistanceIsTheLeastOfAllPairsOfPoints) {
  RandomEngine engine = MakeStream(1, 0, "segments");
  for (int n = 0; n < 100; ++n) {
    const Vector3d p = AnyPoint(engine), q = n % 5 == 0 ? p : AnyPoint(engine);
    const Vector3d r = AnyPoint(engine), s = n % 7 == 0 ? r : AnyPoint(engine);
    double least = 10;
    for (int i = 0; i <= 60; ++i) {
      for (int j = 0; j <= 60; ++j) {
        least = std::min(least, (p + i / 60.0 * (q - p) - r - j / 60.0 * (s - r)).norm());
      }
    }
    const double found = SegmentDistance(p, q, r, s);
    EXPECT_LE(found, least + 1e-12);
    EXPECT_GT(found, least - 0.03);
  }
}

// The planner's capsules against the engine's contacts, at random arm postures.
TEST(ArmBodyTest, TellsCollisionsOfTheArmAsTheEngineDoes) {
  const auto model = LoadModel("armar3b/armar3b.xml");
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               mj_deleteData);
  const Arm& arm = TestArm();
  const auto address = [&](const std::string& joint) {
    return model->jnt_qposadr[mj_name2id(model.get(), mjOBJ_JOINT, joint.c_str())];
  };
  for (int j = 0; j < arm.tree.num_joints(); ++j) {
    data->qpos[address(arm.tree.joint_names[j])] = arm.q[j];
  }
  mj_forward(model.get(), data.get());
  const ArmBody body = ArmBodyOf(arm, *model, *data);
  const int first = mj_name2id(model.get(), mjOBJ_BODY, "arm_r_shoulder1");
  const auto of_arm = [&](int geom) {
    int b = model->geom_bodyid[geom];
    while (b > 0 && b != first) b = model->body_parentid[b];
    return b == first;
  };
  RandomEngine engine = MakeStream(2, 0, "collisions");
  std::vector<Pose> X_WB;
  int touching = 0, agree = 0;
  constexpr int kPostures = 400;
  for (int n = 0; n < kPostures; ++n) {
    Eigen::VectorXd q(7);
    for (int i = 0; i < 7; ++i) {
      const int j = arm.joints[i];
      q[i] = Uniform(engine, arm.tree.lower[j], arm.tree.upper[j]);
      data->qpos[address(arm.tree.joint_names[j])] = q[i];
    }
    mj_forward(model.get(), data.get());
    bool touches = false;
    for (int c = 0; c < data->ncon; ++c) {
      const mjContact& contact = data->contact[c];
      touches = touches || (contact.dist < 0 && of_arm(contact.geom1) != of_arm(contact.geom2));
    }
    touching += touches;
    agree += touches == (SelfClearance(arm, body, q, 0.05, X_WB) < 0);
  }
  EXPECT_GT(touching, kPostures / 50) << "some random postures collide";
  EXPECT_GE(agree, kPostures * 97 / 100);
}

TEST(ArmBodyTest, AnObjectIsAsFarFromTheArmAsFromItsNearestLink) {
  const auto model = LoadModel("armar3b/armar3b.xml");
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               mj_deleteData);
  mj_forward(model.get(), data.get());
  const Arm& arm = TestArm();
  const ArmBody body = ArmBodyOf(arm, *model, *data);
  const Shape ball = ParseShape("sphere:0.04");
  const Eigen::VectorXd q = HomePosture(arm);
  Eigen::VectorXd full = arm.q;
  for (int i = 0; i < arm.num_joints(); ++i) full[arm.joints[i]] = q[i];
  std::vector<Pose> X_WB, scratch;
  ForwardKinematics(arm.tree, full, X_WB);
  const int hand = arm.tree.frames[arm.frame].node;
  RandomEngine engine = MakeStream(3, 0, "objects");
  for (int n = 0; n < 200; ++n) {
    Pose X_WO = Pose::Identity();
    X_WO.translation() =
        0.5 * AnyPoint(engine) + FramePose(arm.tree, X_WB, arm.frame).translation();
    double nearest = 10;
    for (const BodyCapsule& link : body.links) {
      if (link.node == hand) continue;
      const Pose& X = X_WB[link.node];
      const Vector3d p = X_WO.translation();
      nearest = std::min(nearest, SegmentDistance(X * link.a, X * link.b, p, p) - link.radius);
    }
    EXPECT_NEAR(ArmDistance(arm, body, q, ball, X_WO, scratch), nearest - 0.02, 1e-3);
  }
}

TEST(ArmBodyTest, TheHomePostureIsClear) {
  const auto model = LoadModel("armar3b/armar3b.xml");
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(model.get()),
                                                               mj_deleteData);
  mj_forward(model.get(), data.get());
  const ArmBody body = ArmBodyOf(TestArm(), *model, *data);
  EXPECT_GE(body.links.size(), 8u);
  std::vector<Pose> X_WB;
  EXPECT_GT(SelfClearance(TestArm(), body, HomePosture(TestArm()), 0.05, X_WB), 0.01);
}

}  // namespace
}  // namespace springgrasp
