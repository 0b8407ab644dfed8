// A part of a scene made bigger or smaller, all lengths alike.
#pragma once

#include <vector>

#include "sim/mjcf_part.h"

namespace springgrasp {

// Multiplies the lengths (pos, size, fromto) of the part's bodies, joints, geoms, sites, cameras
// and lights by `factor`, in its defaults too; given masses by its cube, as the density stays.
// Angles, joint damping and armature stay. Factor 1 leaves the text as it is. Throws Error for a
// factor that is not positive and for what is not written as such lengths: meshes and height
// fields, <inertial>, slide joints.
void ScaleMjcfPart(XmlDocument& part, double factor);

// Numbers of an attribute, none if it is absent. Throws Error if it holds anything else.
std::vector<double> NumbersOf(const XmlElement& element, const char* attribute);
void SetNumbers(XmlElement& element, const char* attribute, const std::vector<double>& numbers);

}  // namespace springgrasp
