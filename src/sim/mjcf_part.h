// One MJCF file as a part of a scene: read, thinned out, and merged into a bigger document.
#pragma once

#include <mujoco/mujoco.h>
#include <tinyxml2.h>

#include <map>
#include <memory>
#include <string>

namespace springgrasp {

using XmlDocument = tinyxml2::XMLDocument;
using XmlElement = tinyxml2::XMLElement;

// Reads a single-file MJCF (no <include>, angles in radians) and makes it fit for merging: asset
// files get absolute names, and its defaults become one class `prefix`_defaults that all its
// elements without a class of their own belong to. Throws Error.
std::unique_ptr<XmlDocument> ReadMjcfPart(const std::string& path, const std::string& prefix);

// Puts `prefix`_ before every name in the part and before every reference to one, so that parts
// with the same names, or one part twice, can be merged into one scene.
void PrefixNames(XmlDocument& part, const std::string& prefix);

// Removes the geoms of class "visual": nothing of them collides or weighs, but the engine's broad
// phase and kinematics pay for each.
void DropLooks(XmlDocument& part);

// Removes joints and turns their bodies to where the joints stood. Actuators, sensors, tendons and
// equalities on them go too. `model` is the compiled whole file, from which axes and anchors are
// taken. Pairs of neighbours that MuJoCo would no longer exempt from collision, because one of
// them is now fixed to the world, are excluded by name.
void FreezeJoints(XmlDocument& part, const mjModel& model,
                  const std::map<std::string, double>& positions);

// Appends the part's compiler options, defaults, assets, bodies, contacts, tendons, equalities,
// actuators and sensors to the scene. Its own option, size, visual, statistic and keyframe
// sections are left out.
void MergeMjcfPart(const XmlDocument& part, XmlDocument& scene);

// The first descendant <body> of that name, or null.
XmlElement* FindBody(XmlElement* root, const std::string& name);
// Child element, made if it is missing.
XmlElement* ChildOf(XmlElement* parent, const char* name);

}  // namespace springgrasp
