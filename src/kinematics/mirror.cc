#include "kinematics/mirror.h"

namespace springgrasp {
namespace {

const Eigen::Vector3d kWorld(-1, 1, 1), kBody(1, -1, 1);

Pose Reflected(const Eigen::Vector3d& outer, const Pose& X, const Eigen::Vector3d& inner) {
  Pose image = X;
  image.linear() = outer.asDiagonal() * X.linear() * inner.asDiagonal();
  image.translation() = outer.cwiseProduct(X.translation());
  return image;
}

std::string RightName(std::string name) {
  for (const char* part : {"hand_l", "arm_l"}) {
    const std::size_t at = name.find(part);
    if (at != std::string::npos) name[at + std::string(part).size() - 1] = 'r';
  }
  return name;
}

}  // namespace

Pose MirroredBodyPose(const Pose& X_WB) { return Reflected(kWorld, X_WB, kBody); }
Pose MirroredObjectPose(const Pose& X_WO) { return Reflected(kWorld, X_WO, kWorld); }
Eigen::Vector3d MirroredPoint(const Eigen::Vector3d& p_W) { return kWorld.cwiseProduct(p_W); }

KinematicTree MirroredTree(const KinematicTree& tree, bool in_world) {
  KinematicTree image = tree;
  for (KinematicTree::Node& node : image.nodes) {
    node.name = RightName(node.name);
    const bool from_world = in_world && node.parent < 0;
    node.X_PB = Reflected(from_world ? kWorld : kBody, node.X_PB, kBody);
    // A turn changes its sense in a mirror, a shift does not.
    node.axis = (node.slide ? 1 : -1) * kBody.cwiseProduct(node.axis);
    node.p_BC = kBody.cwiseProduct(node.p_BC);
  }
  for (KinematicTree::Frame& frame : image.frames) {
    frame.name = RightName(frame.name);
    frame.X_BF = Reflected(kBody, frame.X_BF, kBody);
  }
  for (std::string& name : image.joint_names) name = RightName(name);
  return image;
}

Arm MirroredArm(const Arm& arm) {
  Arm image = arm;
  image.tree = MirroredTree(arm.tree, true);
  return image;
}

ArmBody MirroredArmBody(const ArmBody& body) {
  ArmBody image = body;
  for (BodyCapsule& link : image.links) {
    const Eigen::Vector3d& mirror = link.node < 0 ? kWorld : kBody;
    link.a = mirror.cwiseProduct(link.a);
    link.b = mirror.cwiseProduct(link.b);
  }
  for (BodyCapsule& rest : image.rest) {
    rest.a = MirroredPoint(rest.a);
    rest.b = MirroredPoint(rest.b);
  }
  for (ArmBody::Block& block : image.blocks) block.X_WO = MirroredObjectPose(block.X_WO);
  return image;
}

}  // namespace springgrasp
