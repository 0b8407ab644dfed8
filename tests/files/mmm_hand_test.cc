// The demonstrator's hands against the published MMM figures, and against each other.
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
const std::map<std::string, std::string> kTips = {{"thumb_tip", "thumb"},
                                                  {"index_tip", "index"},
                                                  {"middle_tip", "middle"},
                                                  {"ring_tip", "ring"},
                                                  {"little_tip", "pinkie"}};

// Largest difference that the source itself has between its hands, at a hand length of 0.189 m.
constexpr double kSidesDiffer = 5e-4;  // m

enum class Side { kRight, kLeft };

std::string PathOf(Side side) {
  return ModelPath(side == Side::kRight ? "mmm_hand/mmm_hand_r.xml" : "mmm_hand/mmm_hand_l.xml");
}

// A point of the source's wrist frame in H: its fingers point to -z; the back of its right hand to
// +x, that of its left hand to -x.
Eigen::Vector3d InH(Side side, const Eigen::Vector3d& p) {
  const double sign = side == Side::kRight ? 1 : -1;
  return {-p.z(), sign * p.y(), sign * p.x()};
}

std::string LastBody(const std::string& finger) {
  return finger == "thumb" ? "mmm_thumb_ip" : "mmm_" + finger + "_dip";
}

// End of the finger on the axis of its last phalanx: the pad's sphere reaches it.
Eigen::Vector3d FingerEnd(const ModelFile& hand, const std::string& finger) {
  const std::string site = "mmm_" + finger + "_tip";
  const double radius = hand.m()->site_size[3 * hand.Id(mjOBJ_SITE, site)];
  return hand.Site(site) + radius * hand.BodyAxes(LastBody(finger)).col(2);
}

ModelFile HandAt(Side side, const std::string& posture) {
  ModelFile hand(PathOf(side));
  const YAML::Node angles = YAML::LoadFile(ModelPath("mmm_hand/" + posture + ".yaml"));
  for (const auto& entry : angles) {
    hand.Angle(entry.first.as<std::string>()) = entry.second.as<double>();
  }
  mj_forward(hand.m(), hand.d());
  return hand;
}

class MmmHand : public testing::TestWithParam<Side> {
 protected:
  static ModelFile Hand() { return ModelFile(PathOf(GetParam())); }
};

INSTANTIATE_TEST_SUITE_P(Sides, MmmHand, testing::Values(Side::kRight, Side::kLeft),
                         [](const auto& side) {
                           return side.param == Side::kRight ? "Right" : "Left";
                         });

TEST_P(MmmHand, ForwardKinematicsMeetsThePublishedPositions) {
  const std::string side = GetParam() == Side::kRight ? "Right" : "Left";
  const std::string prefix = side + "FingerJoint";
  const YAML::Node checks =
      YAML::LoadFile(std::string(SPRINGGRASP_TESTDATA_DIR) + "/mmm_hand_checks.yaml");
  int compared = 0;
  for (const auto& check : checks) {
    SCOPED_TRACE(check["config"].as<std::string>());
    if (!check["expect"][side + "_thumb_tip"]) continue;  // the other hand's
    ModelFile hand = Hand();
    bool ring_moved_at_its_root = false;
    for (const auto& entry : check["q"]) {
      const std::string joint = entry.first.as<std::string>().substr(prefix.size());
      // The source's positive abduction moves a left fingertip away from the thumb, ours towards.
      const bool turned = GetParam() == Side::kLeft && joint.back() == 'x';
      const double angle = (turned ? -1 : 1) * entry.second.as<double>();
      if (kJoints.count(joint)) hand.Angle(kJoints.at(joint)) = angle;
      ring_moved_at_its_root |= joint == "40y";
    }
    mj_kinematics(hand.m(), hand.d());
    for (const auto& entry : check["expect"]) {
      const std::string name = entry.first.as<std::string>().substr(side.size() + 1);
      if (name == "ring_tip" && ring_moved_at_its_root) continue;
      const Eigen::Vector3d p_H = InH(GetParam(), ToVector(entry.second["pos"]));
      const Eigen::Vector3d found =
          kTips.count(name)
              ? FingerEnd(hand, kTips.at(name))
              : hand.Body(kJoints.at(entry.first.as<std::string>().substr(prefix.size())));
      EXPECT_LT((found - p_H).norm(), 1e-5) << name;
      ++compared;
    }
  }
  EXPECT_EQ(compared, 4 * 8 - 1);
}

TEST_P(MmmHand, PositiveAbductionMovesAFingertipTowardsTheThumb) {
  ModelFile hand = Hand();
  const double thumb_side = hand.Site("mmm_thumb_tip").y();
  for (const std::string finger : {"index", "middle", "ring", "pinkie"}) {
    const double before = hand.Site("mmm_" + finger + "_tip").y();
    hand.Angle("mmm_" + finger + "_abduction") = 0.3;
    mj_kinematics(hand.m(), hand.d());
    EXPECT_GT((hand.Site("mmm_" + finger + "_tip").y() - before) * thumb_side, 0) << finger;
  }
}

TEST(MmmHands, LeftMirrorsRightToWithinTheSourcesOwnDifference) {
  for (const std::string posture : {"open", "relaxed"}) {
    const ModelFile right = HandAt(Side::kRight, posture);
    const ModelFile left = HandAt(Side::kLeft, posture);
    const auto mirrored = [](const Eigen::Vector3d& p) {
      return Eigen::Vector3d(p.x(), -p.y(), p.z());
    };
    ASSERT_EQ(left.m()->ngeom, right.m()->ngeom);
    for (int g = 0; g < right.m()->ngeom; ++g) {
      const std::string name = right.Name(mjOBJ_GEOM, g);
      EXPECT_LT((left.Geom(name) - mirrored(right.Geom(name))).norm(), kSidesDiffer)
          << posture << " " << name;
    }
    for (const std::string& finger : kFingers) {
      EXPECT_LT((FingerEnd(left, finger) - mirrored(FingerEnd(right, finger))).norm(), kSidesDiffer)
          << posture << " " << finger;
    }
  }
}

TEST(MmmHands, BothFilesUseTheSameNames) {
  const ModelFile right(PathOf(Side::kRight)), left(PathOf(Side::kLeft));
  for (const mjtObj type : {mjOBJ_BODY, mjOBJ_JOINT, mjOBJ_GEOM, mjOBJ_SITE, mjOBJ_MATERIAL}) {
    const auto names = [type](const ModelFile& hand, int count) {
      std::vector<std::string> all;
      for (int i = 0; i < count; ++i) all.push_back(hand.Name(type, i));
      return all;
    };
    const auto count = [type](const mjModel& m) {
      return type == mjOBJ_BODY    ? m.nbody
             : type == mjOBJ_JOINT ? m.njnt
             : type == mjOBJ_GEOM  ? m.ngeom
             : type == mjOBJ_SITE  ? m.nsite
                                   : m.nmat;
    };
    EXPECT_EQ(names(left, count(*left.m())), names(right, count(*right.m())));
  }
}

TEST_P(MmmHand, HasTwentyOneJointsAndTheGivenLength) {
  const ModelFile hand = Hand();
  EXPECT_EQ(hand.m()->nq, 21);
  const int length = hand.Id(mjOBJ_NUMERIC, "mmm_hand_length");
  EXPECT_EQ(hand.m()->numeric_data[hand.m()->numeric_adr[length]], 0.189);
  EXPECT_NEAR(FingerEnd(hand, "middle").norm(), 0.189, 2e-4);
}

TEST_P(MmmHand, CapsAreCentredOnTheTips) {
  const ModelFile hand = HandAt(GetParam(), "relaxed");
  for (const std::string& finger : kFingers) {
    const std::string cap = "mmm_" + finger + "_cap";
    EXPECT_LT((hand.Geom(cap) - hand.Site("mmm_" + finger + "_tip")).norm(), 1e-8) << finger;
    const int id = hand.Id(mjOBJ_GEOM, cap);
    const int site = hand.Id(mjOBJ_SITE, "mmm_" + finger + "_tip");
    EXPECT_GT(hand.m()->geom_size[3 * id], hand.m()->site_size[3 * site]) << finger;
  }
}

TEST_P(MmmHand, PosturesNameEveryJointOnceWithinItsRange) {
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

TEST_P(MmmHand, CapsOfTheOpenHandAreSeparateSeenFromThePalm) {
  const ModelFile hand = HandAt(GetParam(), "open");
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

TEST_P(MmmHand, RelaxedFingersAreFlexedTowardsThePalmAndThumbLiesOnTheRadialSide) {
  const ModelFile hand = HandAt(GetParam(), "relaxed");
  for (const std::string finger : {"index", "middle", "ring", "pinkie"}) {
    EXPECT_LT(hand.Site("mmm_" + finger + "_tip").z(), -0.03) << finger;
  }
  // y of H points towards the thumb of a right hand, away from that of a left one.
  const double sign = GetParam() == Side::kRight ? 1 : -1;
  EXPECT_GT(sign * hand.Site("mmm_thumb_tip").y(), sign * hand.Site("mmm_index_tip").y());
}

}  // namespace
}  // namespace springgrasp
