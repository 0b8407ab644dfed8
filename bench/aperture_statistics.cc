// When the hand of a grasp is widest, and where its fingertips end, over object widths and reach
// times.
//   aperture_statistics GRASP.yaml...
#include <fmt/format.h>

#include "grasp/aperture.h"
#include "grasp/generate.h"
#include "statistics_main.h"

namespace springgrasp {
namespace {

void PrintRow(const Grasp& grasp, double width, double duration) {
  GenerateOptions options;
  options.shape = grasp.type == "power" ? ParseShape(fmt::format("cylinder:{}x0.18", width))
                                        : ParseShape(fmt::format("sphere:{}", width));
  options.duration = duration;
  const FingertipMotion motion = GenerateMotion(grasp, options);
  const WidestAperture aperture = FindWidestAperture(motion);
  const double late = ContactError(motion, motion.T, motion.T + options.dt);
  const double after = ContactError(motion, motion.T, 1.5 * motion.T);
  fmt::print("{:<7} {:<8} {:>5.0f} {:>5.1f} {:>8.1f} {:>8.1f} {:>6.2f} {:>7.2f} {:>7.2f}\n",
             grasp.type, grasp.profile, 1e3 * width, duration, 1e3 * aperture.start,
             1e3 * aperture.widest, aperture.at, 1e3 * late, 1e3 * after);
}

int Main(int argc, char** argv) {
  fmt::print(
      "aperture at the start and widest (mm), when (of T); largest distance of an involved "
      "tip from its contact at T, and from then on (mm)\n");
  fmt::print("type    profile  width     T    start   widest     at    at T   after\n");
  for (int n = 1; n < argc; ++n) {
    const Grasp grasp = ReadGrasp(argv[n]);
    for (const double width : {0.02, 0.03, 0.04, 0.05, 0.06}) {
      for (const double duration : {0.6, 1.0, 1.5, 2.0}) PrintRow(grasp, width, duration);
    }
  }
  return 0;
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return StatisticsMain(argc, argv, springgrasp::Main); }
