#include "experiment/place_held.h"

#include <gtest/gtest.h>

namespace springgrasp {
namespace {

// An object that stands where it shall, unless a test moves it.
struct Standing {
  PlacedObject Judge() const {
    return JudgePlaced(X_WO, X_WO_place, p_WO_before, window, TrialCriteria());
  }
  Pose X_WO_place = MakePose({0.3, 0.5, 1.0}, Eigen::Quaterniond::Identity());
  Pose X_WO = X_WO_place;
  Eigen::Vector3d p_WO_before = X_WO_place.translation();
  ContactWindow window;
};

TEST(JudgePlacedTest, WhatStandsWhereItShallIsPlaced) {
  Standing object;
  object.X_WO.translation().x() += 0.015;
  object.p_WO_before = object.X_WO.translation();
  object.X_WO.linear() = Eigen::AngleAxisd(2, Eigen::Vector3d::UnitZ()).matrix();
  EXPECT_EQ(object.Judge().fault, "");
  EXPECT_NEAR(object.Judge().error, 0.015, 1e-12);
  EXPECT_NEAR(object.Judge().tilt, 0, 1e-6);
}

TEST(JudgePlacedTest, FarTiltedMovingAndTouchedObjectsAreNot) {
  Standing far, tilted, moving, touched;
  far.X_WO.translation().y() += 0.025;
  far.p_WO_before = far.X_WO.translation();
  tilted.X_WO.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()).matrix();
  moving.p_WO_before.x() += 0.005;
  touched.window.normal[kPinkie] = 0.1;
  for (const Standing& object : {far, tilted, moving, touched}) {
    EXPECT_NE(object.Judge().fault, "");
  }
  EXPECT_NEAR(tilted.Judge().tilt, 0.3, 1e-9);
}

}  // namespace
}  // namespace springgrasp
