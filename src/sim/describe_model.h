// A model in words, for `springgrasp inspect`.
#pragma once

#include <mujoco/mujoco.h>

#include <string>

namespace springgrasp {

// Tables of joints (range), actuators (range, kind), cameras (field of view), bodies with mass.
std::string DescribeModel(const mjModel& model);

}  // namespace springgrasp
