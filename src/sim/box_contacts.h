// MuJoCo's contacts between two boxes, less those that cannot be.
#pragma once

namespace springgrasp {

// Of two boxes that lie flat on each other MuJoCo's collider now and then reports a contact as deep
// as a box is wide and far from both (google-deepmind/mujoco issue 3476; Debian's 2.2 has it in up
// to 1 of 1000 poses), and the solver throws the resting box away; and of a plate on a narrower
// block contacts beside the block. From the first call on, for the
// whole process, contacts outside either box or deeper than the thinner one can sink are dropped.
void DropPhantomBoxContacts();

}  // namespace springgrasp
