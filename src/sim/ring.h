// The small fixed ring on which a sphere lies still: a circle of thin capsules.
#pragma once

namespace springgrasp {

struct Ring {
  int segments = 12;
  double radius = 0;  // m, circle through the capsules' axes' ends
  double tube = 0;    // m, capsule radius; the axes lie at this height above the ring's bottom
};

// Proportioned so that the sphere clears the table by a hair and a finger passes below its
// equator.
Ring RingForSphere(double diameter);

// Height of a sphere's centre above the ring's bottom when it touches the capsules.
double SphereHeightOnRing(const Ring& ring, double radius);

}  // namespace springgrasp
