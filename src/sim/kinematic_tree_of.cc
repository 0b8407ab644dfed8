#include "sim/kinematic_tree_of.h"

#include <algorithm>

#include "base/error.h"
#include "sim/model_index.h"

namespace springgrasp {
namespace {

bool HasBallOrFreeJoint(const mjModel& model, int body) {
  for (int k = 0; k < model.body_jntnum[body]; ++k) {
    const int type = model.jnt_type[model.body_jntadr[body] + k];
    if (type == mjJNT_FREE || type == mjJNT_BALL) return true;
  }
  return false;
}

// Which bodies to take, by id.
std::vector<bool> ChooseBodies(const mjModel& model, int root,
                               const std::vector<std::string>& leaves) {
  std::vector<bool> below(model.nbody, false);
  below[root] = true;
  for (int b = root + 1; b < model.nbody; ++b) {
    below[b] = below[model.body_parentid[b]] && !HasBallOrFreeJoint(model, b);
  }
  if (leaves.empty()) return below;
  std::vector<bool> chosen(model.nbody, false);
  for (const std::string& leaf : leaves) {
    const int site = FindId(model, mjOBJ_SITE, leaf);
    int body = site >= 0 ? model.site_bodyid[site] : FindId(model, mjOBJ_BODY, leaf);
    ThrowUnless(body >= 0, "the model has no body or site named '{}'", leaf);
    ThrowUnless(below[body], "'{}' does not hang by hinges and slides from body '{}'", leaf,
                NameOf(model, mjOBJ_BODY, root));
    for (; body != root; body = model.body_parentid[body]) chosen[body] = true;
  }
  chosen[root] = true;
  return chosen;
}

// Appends the joints of a body as nodes; the last one is the body itself.
int AppendBody(const mjModel& model, int body, int parent, KinematicTree& tree,
               std::vector<double>& lower, std::vector<double>& upper) {
  Pose X_PB = PoseFromQuat(model.body_pos + 3 * body, model.body_quat + 4 * body);
  const std::string name = NameOf(model, mjOBJ_BODY, body);
  const int joints = model.body_jntnum[body];
  for (int k = 0; k < joints; ++k) {
    const int id = model.body_jntadr[body] + k;
    KinematicTree::Node node;
    node.name = k + 1 < joints ? NameOf(model, mjOBJ_JOINT, id) + "_node" : name;
    node.parent = parent;
    node.slide = model.jnt_type[id] == mjJNT_SLIDE;
    node.axis = Vector3From(model.jnt_axis + 3 * id);
    node.joint = tree.num_joints();
    // The node sits on the joint's anchor and is turned back by the reference angle, so that its
    // motion starts at q = 0; what follows the joint undoes the shift.
    const Eigen::Vector3d anchor =
        node.slide ? Eigen::Vector3d::Zero() : Vector3From(model.jnt_pos + 3 * id);
    const double reference = model.qpos0[model.jnt_qposadr[id]];
    node.X_PB = X_PB * Eigen::Translation3d(anchor);
    if (node.slide) {
      node.X_PB.translate(-reference * node.axis);
    } else {
      node.X_PB.rotate(Eigen::AngleAxisd(-reference, node.axis));
    }
    const double free_range = node.slide ? 10.0 : mjPI;
    lower.push_back(model.jnt_limited[id] ? model.jnt_range[2 * id] : -free_range);
    upper.push_back(model.jnt_limited[id] ? model.jnt_range[2 * id + 1] : free_range);
    tree.joint_names.push_back(NameOf(model, mjOBJ_JOINT, id));
    tree.nodes.push_back(node);
    parent = static_cast<int>(tree.nodes.size()) - 1;
    X_PB = Pose(Eigen::Translation3d(-anchor));
  }
  const auto weigh = [&](KinematicTree::Node& node) {
    node.mass = model.body_mass[body];
    node.p_BC = Vector3From(model.body_ipos + 3 * body);
  };
  if (joints > 0 && X_PB.translation().isZero()) {
    weigh(tree.nodes.back());
    return parent;
  }
  KinematicTree::Node fixed;
  if (joints > 0) tree.nodes.back().name += "_node";
  fixed.name = name;
  fixed.parent = parent;
  fixed.X_PB = X_PB;
  weigh(fixed);
  tree.nodes.push_back(fixed);
  return static_cast<int>(tree.nodes.size()) - 1;
}

}  // namespace

KinematicTree KinematicTreeOf(const mjModel& model, const std::string& root_body,
                              const std::vector<std::string>& leaves) {
  const int root = IdOf(model, mjOBJ_BODY, root_body);
  const std::vector<bool> chosen = ChooseBodies(model, root, leaves);
  KinematicTree tree;
  std::vector<double> lower, upper;
  std::vector<int> node_of(model.nbody, -1);
  KinematicTree::Node base;
  base.name = root_body;
  tree.nodes.push_back(base);
  node_of[root] = 0;
  for (int b = root + 1; b < model.nbody; ++b) {
    if (chosen[b]) {
      node_of[b] = AppendBody(model, b, node_of[model.body_parentid[b]], tree, lower, upper);
    }
  }
  for (int s = 0; s < model.nsite; ++s) {
    const int node = node_of[model.site_bodyid[s]];
    if (node < 0) continue;
    tree.frames.push_back({NameOf(model, mjOBJ_SITE, s), node,
                           PoseFromQuat(model.site_pos + 3 * s, model.site_quat + 4 * s)});
  }
  tree.lower = Eigen::Map<Eigen::VectorXd>(lower.data(), static_cast<Eigen::Index>(lower.size()));
  tree.upper = Eigen::Map<Eigen::VectorXd>(upper.data(), static_cast<Eigen::Index>(upper.size()));
  return tree;
}

Eigen::VectorXd JointPositions(const KinematicTree& tree, const mjModel& model,
                               const mjData& data) {
  Eigen::VectorXd q(tree.num_joints());
  for (int i = 0; i < tree.num_joints(); ++i) {
    q[i] = data.qpos[model.jnt_qposadr[IdOf(model, mjOBJ_JOINT, tree.joint_names[i])]];
  }
  return q;
}

}  // namespace springgrasp
