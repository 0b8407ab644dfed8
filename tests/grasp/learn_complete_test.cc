// Fingers that nobody saw begin or close.
#include "grasp/learn_complete.h"

#include <gtest/gtest.h>

#include "grasp/learn.h"
#include "synthetic_demonstration.h"

namespace springgrasp {
namespace {

using Eigen::Vector3d;

constexpr double kBegin = 0.1, kEnd = 1.1;  // s, of the reach in a synthetic demonstration

// A tripod grasp whose thumb is hidden in the first and the last third of the reach.
Demonstration WithHiddenThumb(const SyntheticGrasp& made) {
  RandomEngine engine = MakeStream(1, 0, "learn_complete_test");
  Demonstration demonstration = MakeDemonstration(made, engine);
  for (DemonstrationSample& sample : demonstration.samples) {
    if (sample.t < kBegin + 0.3 || sample.t > kEnd - 0.2) sample.p_WF[kThumb].reset();
  }
  return demonstration;
}

SyntheticGrasp Tripod() {
  SyntheticGrasp made;
  made.type = "tripod";
  made.shape = ParseShape("sphere:0.05");
  return made;
}

ReachSegment Reach(const HandTrack& track) {
  ReachSegment reach;
  reach.begin = static_cast<int>(kBegin / track.dt);
  reach.contact = static_cast<int>(kEnd / track.dt);
  return reach;
}

TEST(CompleteFingers, AHiddenThumbIsFollowedToBothEnds) {
  const SyntheticGrasp made = Tripod();
  RandomEngine engine = MakeStream(1, 0, "learn_complete_test");
  const HandTrack truth = MakeHandTrack(MakeDemonstration(made, engine));
  HandTrack track = MakeHandTrack(WithHiddenThumb(made));
  const ReachSegment reach = Reach(track);
  const SeenAtEnds seen = FindSeenAtEnds(track, reach);
  EXPECT_FALSE(seen.begin[kThumb]);
  EXPECT_FALSE(seen.contact[kThumb]);
  EXPECT_TRUE(seen.begin[kIndex] && seen.contact[kIndex]);
  const auto begin = static_cast<std::size_t>(reach.begin);
  const auto contact = static_cast<std::size_t>(reach.contact);
  const auto error = [&](std::size_t n) {
    return (track.p_HF[n][kThumb] - truth.p_HF[n][kThumb]).norm();
  };
  const double before[] = {error(begin), error(contact)};
  const Vector3d index = track.p_HF[begin][kIndex];
  CompleteFingers(seen, InvolvedFingers("tripod"), reach, {}, track);
  EXPECT_LT(error(begin), 0.3 * before[0]);
  EXPECT_LT(error(contact), 0.3 * before[1]);
  EXPECT_EQ(track.p_HF[begin][kIndex], index);  // who was seen stays
  for (std::size_t n = 1; n < track.p_HF.size(); ++n) {
    EXPECT_LT((track.p_HF[n][kThumb] - track.p_HF[n - 1][kThumb]).norm(), 0.003) << n;
  }
}

TEST(HiddenContacts, AThumbOpposesTheFingers) {
  const SyntheticGrasp made = Tripod();
  LearnOptions options;
  options.type = "tripod";
  const Grasp grasp = LearnGrasp(WithHiddenThumb(made), options);
  PerFinger<Vector3d> p_GC, n_G;
  SyntheticContacts(made, p_GC, n_G);
  const Vector3d p_OC = grasp.X_OH * grasp.X_HG * p_GC[kThumb];
  const auto found = ContactOfRay(made.shape, grasp.rays[kThumb], grasp.tip_radius);
  ASSERT_TRUE(found);
  EXPECT_LT((found->p_OC - p_OC).norm(), 0.004);
}

}  // namespace
}  // namespace springgrasp
