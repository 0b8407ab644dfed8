#include "experiment/grasp_requests.h"

#include <algorithm>
#include <cmath>

namespace springgrasp {

std::vector<KnownTips> TipsOf(const FingertipMotion& motion) {
  std::vector<KnownTips> tips(motion.samples.size());
  for (std::size_t i = 0; i < tips.size(); ++i) {
    for (int f = 0; f < kNumFingers; ++f) tips[i][f] = motion.samples[i].p_HF[f];
  }
  return tips;
}

std::size_t ContactSample(const FingertipMotion& motion, double dt) {
  return std::min(motion.samples.size() - 1, static_cast<std::size_t>(std::lround(motion.T / dt)));
}

ContactRequest RequestContacts(const HumanHand& human, const RobotHand& hand,
                               const FingertipMotion& motion, const Eigen::VectorXd& q_human) {
  ContactRequest contacts;
  contacts.type = motion.type;
  contacts.involved = motion.involved;
  contacts.shape = motion.shape;
  contacts.p_OC = motion.p_OC;
  contacts.n_OC = motion.n_OC;
  contacts.X_OH_human = motion.X_HO.inverse();
  contacts.X_OG = contacts.X_OH_human * motion.X_HG;
  contacts.human = TargetFromHuman(human, q_human, hand);
  return contacts;
}

HandMotionRequest RequestHandMotion(const FingertipMotion& motion,
                                    const std::vector<Eigen::VectorXd>& q_human,
                                    const ContactPosture& posture, const std::vector<Pose>& X_WH,
                                    const Pose& X_WO, double dt) {
  HandMotionRequest request;
  request.dt = dt;
  request.T = motion.T;
  request.t_switch = motion.t_switch;
  request.q_human = q_human;
  request.involved = motion.involved;
  request.shape = motion.shape;
  const Pose X_OW = X_WO.inverse();
  const Pose X_RobotHuman = posture.X_HO * motion.X_HO.inverse();
  for (std::size_t i = 0; i < motion.samples.size(); ++i) {
    PerFinger<Eigen::Vector3d> tips;
    for (int f = 0; f < kNumFingers; ++f) {
      tips[f] = X_RobotHuman * motion.samples[i].p_HF[f];
      // The robot's pads touch where the posture has slid them to.
      if (motion.involved[f]) tips[f] += posture.X_HO.linear() * (posture.p_OC[f] - motion.p_OC[f]);
    }
    request.p_HF.push_back(tips);
    request.X_OH.push_back(X_OW * X_WH[i]);
  }
  return request;
}

}  // namespace springgrasp
