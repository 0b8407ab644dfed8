// The frames of a grasp: G between the fingers, O where no object was given.
#pragma once

#include <string>

#include "base/fingers.h"
#include "base/pose.h"
#include "base/shape.h"

namespace springgrasp {

// Pose of the grasp frame G in frame A from the fingertips p_AF at contact: origin midway between
// thumb tip and the mean of the other involved tips, x from thumb to fingers, z towards the wrist
// p_AWrist made orthogonal to x. Throws Error if the thumb or every finger is uninvolved.
Pose GraspFrame(const PerFinger<Eigen::Vector3d>& p_AF, const PerFinger<bool>& involved,
                const Eigen::Vector3d& p_AWrist);

// The object made from the grasp where none was given: origin of G, x of G, z the part of `up_A`
// orthogonal to x; a sphere whose diameter is the thumb-finger distance less two tip radii.
struct InferredObject {
  Pose X_AO = Pose::Identity();
  Shape shape;
};
InferredObject InferObject(const PerFinger<Eigen::Vector3d>& p_AF, const PerFinger<bool>& involved,
                           const Pose& X_AG, const Eigen::Vector3d& up_A, double tip_radius);

// Fingers that take part in a grasp of this type: pinch, tripod, power, lateral. Throws Error.
PerFinger<bool> InvolvedFingers(const std::string& type);

}  // namespace springgrasp
