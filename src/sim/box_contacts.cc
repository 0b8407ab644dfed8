#include "sim/box_contacts.h"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>

namespace springgrasp {
namespace {

mjfCollision collide_boxes = nullptr;  // MuJoCo's own

// How far a point (W) is outside a box along its worst axis, m.
double Outside(const mjModel& m, const mjData& d, int geom, const mjtNum* p) {
  const mjtNum* centre = d.geom_xpos + 3 * geom;
  const mjtNum* R = d.geom_xmat + 9 * geom;
  const mjtNum offset[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};
  mjtNum local[3];
  mju_rotVecMatT(local, offset, R);
  double outside = 0;
  for (int i = 0; i < 3; ++i) {
    outside = std::max(outside, std::abs(local[i]) - m.geom_size[3 * geom + i]);
  }
  return outside;
}

double Thickness(const mjModel& m, int geom) {
  const mjtNum* half = m.geom_size + 3 * geom;
  return 2 * std::min({half[0], half[1], half[2]});
}

int CollideBoxes(const mjModel* m, const mjData* d, mjContact* contacts, int geom1, int geom2,
                 mjtNum margin) {
  constexpr double kSlack = 0.001, kSunk = 0.01;  // m; a thin card that falls sinks in for a moment
  const int found = collide_boxes(m, d, contacts, geom1, geom2, margin);
  const double deepest = std::min(Thickness(*m, geom1), Thickness(*m, geom2)) + kSunk;
  // A contact's point is in the middle between the two surfaces.
  return static_cast<int>(std::remove_if(contacts, contacts + found,
                                         [&](const mjContact& c) {
                                           const double beyond = 0.5 * std::abs(c.dist) + kSlack;
                                           return -c.dist > deepest ||
                                                  Outside(*m, *d, geom1, c.pos) > beyond ||
                                                  Outside(*m, *d, geom2, c.pos) > beyond;
                                         }) -
                          contacts);
}

}  // namespace

void DropPhantomBoxContacts() {
  static const bool once = [] {
    collide_boxes = mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX];
    mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX] = CollideBoxes;
    return true;
  }();
  static_cast<void>(once);
}

}  // namespace springgrasp
