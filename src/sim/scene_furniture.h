// What a scene has besides the robot, written as MJCF elements.
#pragma once

#include "base/shape.h"
#include "sim/mjcf_part.h"
#include "sim/scene.h"

namespace springgrasp {

// Compiler, physics options, buffer sizes, picture quality.
void AddSettings(const Scene& scene, int offscreen_samples, XmlElement* root);
// Floor, sky, lights, overview cameras.
void AddSurroundings(const Scene& scene, XmlElement* root);
// Fixed body `table`; its frame is the middle of the top.
void AddTable(const Scene& scene, XmlElement* root);
// Fixed body `<object>_pedestal` under an object that stands on one; nothing for others.
void AddPedestal(const Scene& scene, int object, XmlElement* root);
// Fixed body `<object>_slot`: two jaws beside the thinner side of an upright plate; nothing for
// others.
void AddSlot(const Scene& scene, int object, XmlElement* root);
// Fixed body `<object>_ring` under an object that is on_ring; nothing for others.
void AddRing(const Scene& scene, int object, XmlElement* root);
// Free body `<object>` with joint `<object>_free`.
void AddObject(const Scene& scene, int object, XmlDocument& document);
// Mocap body `shown_object` that collides with nothing.
void AddShownObject(const Shape& shape, const Scene& scene, XmlElement* root);

// Switches off all collisions of the geoms below an element.
void MakeIntangible(XmlElement* element);

}  // namespace springgrasp
