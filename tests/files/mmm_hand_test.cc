// The demonstrator's hand against the published MMM figures.
#include <map>
#include <set>
#include <vector>

#include "files/model_file.h"

namespace springgrasp {
namespace {

const std::vector<std::string> kFingers = {"thumb", "index", "middle", "ring", "pinkie"};

// Joints of the source by the names used here; the ring's CMC joint (40y) is held at zero.
const std::map<std::string, std::string> kJoints = {{"11z", "mmm_thumb_cmc_opposition"},
                                                    {"11y", "mmm_thumb_cmc_flexion"},
                                                    {"12y", "mmm_thumb_mcp"},
                                                    {"13y", "mmm_thumb_ip"},
                                                    {"21x", "mmm_index_abduction"},
                                                    {"21y", "mmm_index_mcp"},
                                                    {"22y", "mmm_index_pip"},
                                                    {"23y", "mmm_index_dip"},
                                                    {"31x", "mmm_middle_abduction"},
                                                    {"31y", "mmm_middle_mcp"},
                                                    {"32y", "mmm_middle_pip"},
                                                    {"33y", "mmm_middle_dip"},
                                                    {"41x", "mmm_ring_abduction"},
                                                    {"41y", "mmm_ring_mcp"},
                                                    {"42y", "mmm_ring_pip"},
                                                    {"43y", "mmm_ring_dip"},
                                                    {"50y", "mmm_pinkie_cmc"},
                                                    {"51x", "mmm_pinkie_abduction"},
                                                    {"51y", "mmm_pinkie_mcp"},
                                                    {"52y", "mmm_pinkie_pip"},
                                                    {"53y", "mmm_pinkie_dip"}};
const std::map<std::string, std::string> kTips = {{"Right_thumb_tip", "thumb"},
                                                  {"Right_index_tip", "index"},
                                                  {"Right_middle_tip", "middle"},
                                                  {"Right_ring_tip", "ring"},
                                                  {"Right_little_tip", "pinkie"}};

ModelFile Hand() { return ModelFile(ModelPath("mmm_hand/mmm_hand_r.xml")); }

std::string LastBody(const std::string& finger) {
  return finger == "thumb" ? "mmm_thumb_ip" : "mmm_" + finger + "_dip";
}

// End of the finger on the axis of its last phalanx: the pad's sphere reaches it.
Eigen::Vector3d FingerEnd(const ModelFile& hand, const std::string& finger) {
  const std::string site = "mmm_" + finger + "_tip";
  const double radius = hand.m()->site_size[3 * hand.Id(mjOBJ_SITE, site)];
  return hand.Site(site) + radius * hand.BodyAxes(LastBody(finger)).col(2);
}

ModelFile HandAt(const std::string& posture) {
  ModelFile hand = Hand();
  const YAML::Node angles = YAML::LoadFile(ModelPath("mmm_hand/" + posture + ".yaml"));
  for (const auto& entry : angles) {
    hand.Angle(entry.first.as<std::string>()) = entry.second.as<double>();
  }
  mj_forward(hand.m(), hand.d());
  return hand;
}

TEST(MmmHand, ForwardKinematicsMeetsThePublishedPositions) {
  const YAML::Node checks =
      YAML::LoadFile(std::string(SPRINGGRASP_TESTDATA_DIR) + "/mmm_hand_checks.yaml");
  int compared = 0;
  for (const auto& check : checks) {
    SCOPED_TRACE(check["config"].as<std::string>());
    ModelFile hand = Hand();
    bool ring_moved_at_its_root = false;
    for (const auto& entry : check["q"]) {
      const std::string joint = entry.first.as<std::string>().substr(16);
      if (kJoints.count(joint)) hand.Angle(kJoints.at(joint)) = entry.second.as<double>();
      ring_moved_at_its_root |= joint == "40y";
    }
    mj_kinematics(hand.m(), hand.d());
    for (const auto& entry : check["expect"]) {
      const std::string name = entry.first.as<std::string>();
      if (name == "Right_ring_tip" && ring_moved_at_its_root) continue;
      const Eigen::Vector3d p = ToVector(entry.second["pos"]);
      const Eigen::Vector3d p_H(-p.z(), p.y(),
                                p.x());  // the source's fingers point to -z, its back to x
      const Eigen::Vector3d found = kTips.count(name) ? FingerEnd(hand, kTips.at(name))
                                                      : hand.Body(kJoints.at(name.substr(16)));
      EXPECT_LT((found - p_H).norm(), 1e-5) << name;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 4 * 8 - 1);
}

TEST(MmmHand, HasTwentyOneJointsAndTheGivenLength) {
  const ModelFile hand = Hand();
  EXPECT_EQ(hand.m()->nq, 21);
  EXPECT_NEAR(FingerEnd(hand, "middle").norm(), 0.189, 2e-4);
}

TEST(MmmHand, CapsAreCentredOnTheTips) {
  const ModelFile hand = HandAt("relaxed");
  for (const std::string& finger : kFingers) {
    const std::string cap = "mmm_" + finger + "_cap";
    EXPECT_LT((hand.Geom(cap) - hand.Site("mmm_" + finger + "_tip")).norm(), 1e-8) << finger;
    const int id = hand.Id(mjOBJ_GEOM, cap);
    const int site = hand.Id(mjOBJ_SITE, "mmm_" + finger + "_tip");
    EXPECT_GT(hand.m()->geom_size[3 * id], hand.m()->site_size[3 * site]) << finger;
  }
}

TEST(MmmHand, PosturesNameEveryJointOnceWithinItsRange) {
  for (const std::string posture : {"relaxed", "open"}) {
    SCOPED_TRACE(posture);
    const ModelFile hand = Hand();
    const YAML::Node angles = YAML::LoadFile(ModelPath("mmm_hand/" + posture + ".yaml"));
    std::set<std::string> named;
    for (const auto& entry : angles) {
      const std::string joint = entry.first.as<std::string>();
      const int j = hand.Id(mjOBJ_JOINT, joint);
      EXPECT_GE(entry.second.as<double>(), hand.m()->jnt_range[2 * j]) << joint;
      EXPECT_LE(entry.second.as<double>(), hand.m()->jnt_range[2 * j + 1]) << joint;
      named.insert(joint);
    }
    EXPECT_EQ(named.size(), 21u);
    EXPECT_EQ(angles.size(), 21u);
  }
}

TEST(MmmHand, CapsOfTheOpenHandAreSeparateSeenFromThePalm) {
  const ModelFile hand = HandAt("open");
  for (size_t a = 0; a < kFingers.size(); ++a) {
    for (size_t b = a + 1; b < kFingers.size(); ++b) {
      const std::string first = "mmm_" + kFingers[a] + "_cap",
                        second = "mmm_" + kFingers[b] + "_cap";
      auto reach = [&](const std::string& cap) {
        const double* size = hand.m()->geom_size + 3 * hand.Id(mjOBJ_GEOM, cap);
        return size[0] + size[1];
      };
      const Eigen::Vector3d between = hand.Geom(first) - hand.Geom(second);
      EXPECT_GT(between.head<2>().norm(), reach(first) + reach(second) + 0.003)
          << first << " and " << second;
    }
  }
}

TEST(MmmHand, RelaxedFingersAreFlexedTowardsThePalmAndThumbLiesOnTheRadialSide) {
  const ModelFile hand = HandAt("relaxed");
  for (const std::string finger : {"index", "middle", "ring", "pinkie"}) {
    EXPECT_LT(hand.Site("mmm_" + finger + "_tip").z(), -0.03) << finger;
  }
  EXPECT_GT(hand.Site("mmm_thumb_tip").y(), hand.Site("mmm_index_tip").y());
}

}  // namespace
}  // namespace springgrasp
