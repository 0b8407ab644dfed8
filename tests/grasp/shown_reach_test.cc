#include "grasp/shown_reach.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "grasp/generate.h"
#include "grasp/grasp_frame.h"
#include "grasp/library.h"

namespace springgrasp {
namespace {

TEST(ShownReachTest, DemonstratedTipsRunFromTheStartToTheContacts) {
  for (const char* type : {"pinch", "power"}) {
    const std::string path = ShippedLibrary() + "/" + type + ".yaml";
    const Grasp grasp = ReadGrasp(path);
    const auto tips = DemonstratedTips(ReadDemonstration(DemonstrationOfEntry(path)), grasp, 101);
    ASSERT_EQ(tips.size(), 101u);
    const PerFinger<Contact> contacts = ContactsOn(grasp, grasp.shape, grasp.tip_radius);
    for (int f = 0; f < kNumFingers; ++f) {
      if (!grasp.involved[f]) continue;
      const Eigen::Vector3d p_HC = grasp.X_OH.inverse() * contacts[f].p_OC;
      EXPECT_LT((tips.back()[f] - p_HC).norm(), 0.012) << type << " " << kFingerNames[f];
      EXPECT_GT((tips.front()[f] - p_HC).norm(), (tips.back()[f] - p_HC).norm());
    }
  }
}

TEST(ShownReachTest, APinchWithoutTheIndexFingerIsAnError) {
  Demonstration shown = ReadDemonstration(DemonstrationOfEntry(ShippedLibrary() + "/pinch.yaml"));
  for (DemonstrationSample& sample : shown.samples) sample.p_WF[kIndex].reset();
  EXPECT_THROW(FindShownReach(shown, "pinch", InvolvedFingers("pinch")), Error);
}

}  // namespace
}  // namespace springgrasp
