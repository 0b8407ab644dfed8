#include "sim/box_contacts.h"

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "sim/mujoco_handles.h"

namespace springgrasp {
namespace {

constexpr char kTwoBoxes[] = R"(
<mujoco>
  <worldbody>
    <geom type="box" size="0.4 0.3 0.02" pos="0.4 0.5 0.8"/>
    <body><freejoint/><geom type="box" size="0.02 0.02 0.08" mass="0.1"/></body>
  </worldbody>
</mujoco>)";

struct Boxes {
  ModelPtr model;
  DataPtr data;
};

Boxes MakeBoxes() {
  Boxes boxes;
  boxes.model = LoadModelText(kTwoBoxes, "two boxes");
  boxes.data = MakeData(*boxes.model);
  return boxes;
}

void Place(Boxes& boxes, double x, double y, double z, const Eigen::Quaterniond& q) {
  const double qpos[] = {x, y, z, q.w(), q.x(), q.y(), q.z()};
  std::copy(std::begin(qpos), std::end(qpos), boxes.data->qpos);
  mj_fwdPosition(boxes.model.get(), boxes.data.get());
}

TEST(BoxContactsTest, ABoxThatStandsFlatTouchesNowhereButUnderItself) {
  Boxes boxes = MakeBoxes();
  RandomEngine engine = MakeStream(1, 0, "box_contacts_test");
  const auto deepest_of_many = [&] {
    double deepest = 0;
    for (int i = 0; i < 40000; ++i) {
      const double yaw = Uniform(engine, -std::numbers::pi, std::numbers::pi);
      const double x = Uniform(engine, 0.3, 0.5), y = Uniform(engine, 0.4, 0.6);
      Place(boxes, x, y, 0.9 - Uniform(engine, 0, 1e-4),
            Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())));
      for (int c = 0; c < boxes.data->ncon; ++c) {
        deepest = std::max(deepest, -boxes.data->contact[c].dist);
      }
    }
    return deepest;
  };
  // MuJoCo alone: should this fail, it has been mended there.
  EXPECT_GT(deepest_of_many(), 0.1);
  DropPhantomBoxContacts();
  DropPhantomBoxContacts();
  EXPECT_LT(deepest_of_many(), 2e-4);
}

TEST(BoxContactsTest, APlateOnANarrowBlockTouchesNowhereBesideIt) {
  DropPhantomBoxContacts();
  const ModelPtr model = LoadModelText(R"(
<mujoco>
  <worldbody>
    <geom type="box" size="0.015 0.015 0.05" pos="0 0 0.05"/>
    <body pos="0 0 0.1025"><freejoint/><geom type="box" size="0.04 0.08 0.0025" mass="0.03"/></body>
  </worldbody>
</mujoco>)",
                                       "plate");
  const DataPtr data = MakeData(*model);
  int contacts = 0;
  for (int i = 0; i < 200; ++i) {
    mj_step(model.get(), data.get());
    for (int c = 0; c < data->ncon; ++c, ++contacts) {
      EXPECT_LT(std::abs(data->contact[c].pos[0]), 0.0161);
      EXPECT_LT(std::abs(data->contact[c].pos[1]), 0.0161);
    }
  }
  EXPECT_GT(contacts, 600);
  EXPECT_GT(data->xmat[9 + 8], 0.999);
}

TEST(BoxContactsTest, RealContactsStay) {
  DropPhantomBoxContacts();
  Boxes boxes = MakeBoxes();
  const Eigen::Quaterniond tipped(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()));
  Place(boxes, 0.4, 0.5, 0.9 - 0.0001, Eigen::Quaterniond::Identity());
  EXPECT_EQ(boxes.data->ncon, 4);
  // Sunk in by 10 mm, on an edge.
  const double lowest = 0.08 * std::cos(0.3) + 0.02 * std::sin(0.3);
  Place(boxes, 0.4, 0.5, 0.82 + lowest - 0.01, tipped);
  EXPECT_GE(boxes.data->ncon, 2);
  EXPECT_LT(boxes.data->contact[0].dist, -0.004);
}

}  // namespace
}  // namespace springgrasp
