// What a grasp that was learned without its object leaves open when it meets a real one.
#pragma once

#include "base/shape.h"
#include "grasp/grasp.h"
#include "grasp/object_contacts.h"

namespace springgrasp {

// An object inferred from the grasp has a size but no axis: its O stands upright only because `up`
// does. Where a whole hand (power) that enclosed such an object meets a cylinder, the cylinder's
// axis takes the place of the axis that the hand enclosed: O's z becomes G's y (across the
// fingers), the thumb's side up; contacts keep their distances along it. Other grasps are returned
// as they are.
Grasp EncloseAlongAxis(const Grasp& grasp, const Shape& shape);

// Parts of one grasp in the place of another's, of the same type: the contacts and the frames that
// belong to them; the springs and all that drives them.
void TakeContacts(const Grasp& from, Grasp& to);
void TakeSprings(const Grasp& from, Grasp& to);

// Contacts of a lateral grasp of a box on another: thumb and fingers opposite each other on the two
// large faces, `inset` (m) from that end of the longest side where the wrist is, else where they
// were as a fraction of the face, but `inset` from the edges or in the middle of a narrower one.
// Rays from O would move along the faces with the thickness. Both shapes must be boxes.
PerFinger<Contact> PlateContacts(const Grasp& grasp, const Shape& shape, double tip_radius,
                                 double inset);

}  // namespace springgrasp
