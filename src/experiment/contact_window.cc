#include "experiment/contact_window.h"

namespace springgrasp {

double WeightError(const ContactWindow& window, const Eigen::Matrix3d& R_WH, double weight) {
  Eigen::Vector3d f_H = window.palm_f_H;
  for (const Eigen::Vector3d& f : window.f_H) f_H += f;
  return (R_WH * f_H - Eigen::Vector3d(0, 0, weight)).norm() / weight;
}

ContactAccumulator::ContactAccumulator(const std::vector<GeomRole>& roles, int object_body)
    : roles_(roles), body_(object_body) {}

void ContactAccumulator::Add(const std::vector<ContactPoint>& contacts, const Pose& X_WO_com,
                             const Pose& X_WH, double torsion, double dt) {
  sum_.duration += dt;
  sum_.R_WO = X_WO_com.linear();
  for (const ContactPoint& c : contacts) {
    const bool is_second = c.body2 == body_;
    if (!is_second && c.body1 != body_) continue;
    const int other = is_second ? c.geom1 : c.geom2;
    const GeomRole& role = roles_[other];
    if (!role.hand()) {
      sum_.support_normal += c.normal_force * dt;
      continue;
    }
    const double sign = is_second ? 1 : -1;  // force and normal onto the object
    const Eigen::Vector3d f_H = X_WH.linear().transpose() * (sign * c.f_W);
    sum_.total_normal += c.normal_force * dt;
    if (role.part == GeomPart::kPalm) {
      sum_.palm_normal += c.normal_force * dt;
      sum_.palm_f_H += f_H * dt;
    } else {
      sum_.normal[role.finger] += c.normal_force * dt;
      sum_.f_H[role.finger] += f_H * dt;
      if (role.phalanx == 0) sum_.proximal_normal[role.finger] += c.normal_force * dt;
    }
    Sum& geom = per_geom_[other];
    const double w = c.normal_force * dt;
    geom.role = role;
    geom.weight += w;
    geom.p += w * (X_WO_com.inverse() * c.p_W);
    geom.n += w * sign * (X_WO_com.linear().transpose() * c.R_WC.col(0));
    geom.friction += w * c.friction;
    geom.torsion += w * torsion;
  }
}

ContactWindow ContactAccumulator::Mean() const {
  ContactWindow mean = sum_;
  if (sum_.duration <= 0) return mean;
  const double scale = 1 / sum_.duration;
  for (int f = 0; f < kNumFingers; ++f) {
    mean.normal[f] *= scale;
    mean.proximal_normal[f] *= scale;
    mean.f_H[f] *= scale;
  }
  mean.palm_normal *= scale;
  mean.palm_f_H *= scale;
  mean.total_normal *= scale;
  mean.support_normal *= scale;
  for (const auto& [geom, sum] : per_geom_) {
    if (sum.weight <= 0 || sum.n.norm() < 1e-9) continue;
    MeanContact contact;
    contact.role = sum.role;
    contact.normal = sum.weight * scale;
    contact.geometry.p = sum.p / sum.weight;
    contact.geometry.n = sum.n.normalized();
    contact.geometry.friction = sum.friction / sum.weight;
    contact.geometry.torsion = sum.torsion / sum.weight;
    mean.contacts.push_back(contact);
  }
  return mean;
}

void ContactAccumulator::Clear() {
  sum_ = ContactWindow();
  per_geom_.clear();
}

}  // namespace springgrasp
