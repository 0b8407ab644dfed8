// The demonstrator's hand as a part of a scene: as long as the scene says, with its caps and skin.
#pragma once

#include <memory>
#include <string>

#include "sim/mjcf_part.h"
#include "sim/scene.h"

namespace springgrasp {

// Reads a hand file (body `mmm_hand` in its world, its length in metres in the custom number
// `mmm_hand_length`) and scales it to scene.demonstrator.hand_length. A cap `mmm_<finger>_cap`
// stays centred on the site `mmm_<finger>_tip`, whose size is the pad's radius: its straight part
// keeps its length and its radius stays that of the pad plus what the file added, or becomes half
// of demonstrator.cap_diameter. Colours go to the materials `mmm_cap` and `mmm_skin`. Throws Error
// if one of these names is missing or a cap would not cover its pad.
std::unique_ptr<XmlDocument> ReadDemonstratorPart(const std::string& path, const Scene& scene);

}  // namespace springgrasp
