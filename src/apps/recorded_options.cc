#include "apps/recorded_options.h"

#include <algorithm>

#include "base/error.h"

namespace springgrasp {

std::vector<CLI::Option*> AddRecordedOptions(CLI::App& command, ObserveRecordedOptions& options) {
  command.add_option("--left", options.left, "recorded video or image pattern, left camera");
  command.add_option("--right", options.right, "the same of the right camera");
  command.add_option("--intrinsics", options.intrinsics, "M1 D1 M2 D2, as stereo_calib writes");
  command.add_option("--extrinsics", options.extrinsics, "R T (metres), likewise");
  return {command.add_option("--camera-pose", options.camera_pose,
                             "\"x y z qw qx qy qz\" of the left camera in the world"),
          command.add_option("--marker-hue", options.marker_hue,
                             "of the caps, degrees (0 red, 120 green, 240 blue), or auto"),
          command.add_option("--cap-diameter", options.cap_diameter, "metres (default: found)")
              ->check(CLI::Range(0.005, 0.05)),
          command.add_option("--cap-length", options.cap_length, "metres, tip's end to open end")
              ->check(CLI::Range(0.005, 0.1)),
          command
              .add_option("--cap-centre", options.cap_centre,
                          "metres, tip's end to the point that is written (default: the radius)")
              ->check(CLI::Range(0.001, 0.1)),
          command.add_option("--hand", options.hand, "that shows its palm: right or left")
              ->check(CLI::IsMember({"right", "left"}))};
}

bool AnyGiven(const std::vector<CLI::Option*>& options) {
  return std::any_of(options.begin(), options.end(),
                     [](const CLI::Option* option) { return option->count() > 0; });
}

bool IsRecorded(const ObserveRecordedOptions& options) {
  const std::pair<const char*, const std::string*> needed[] = {
      {"--left", &options.left},
      {"--right", &options.right},
      {"--intrinsics", &options.intrinsics},
      {"--extrinsics", &options.extrinsics}};
  const bool any = std::any_of(std::begin(needed), std::end(needed),
                               [](const auto& option) { return !option.second->empty(); });
  for (const auto& [name, value] : needed) {
    ThrowUnless(!any || !value->empty(), "recorded video needs {} too", name);
  }
  return any;
}

}  // namespace springgrasp
