// How well learned springs reproduce demonstrations, in H, against the smoothed track: with the
// central force of profile human, with that of profile paper (Eq. (7) and no more), and without.
//   reproduction_statistics TYPE=DEMO.csv...
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "demonstration/demonstration.h"
#include "grasp/learn.h"
#include "statistics_main.h"

namespace springgrasp {
namespace {

void PrintRow(const std::string& name, const std::string& profile, const Grasp& grasp) {
  const GraspQuality& quality = grasp.quality;
  fmt::print("{:<18} {:<9}", name, profile);
  for (int i = 0; i < kNumFingers; ++i) {
    if (grasp.observed[i]) {
      fmt::print(" {:>5.1f}{}", 1e3 * quality.rmse[i], grasp.involved[i] ? '*' : ' ');
    } else {
      fmt::print("      - ");
    }
  }
  fmt::print(" {:>5.1f} {:>6.1f} {:>6.1f} {:>6.1f} {:>6.2f} {:>6.2f}\n", 1e3 * quality.reach_rmse,
             1e3 * quality.aperture_rmse, 1e3 * quality.aperture, 1e3 * quality.aperture_reproduced,
             quality.aperture_time, quality.aperture_time_reproduced);
  std::fflush(stdout);
}

int Main(int argc, char** argv) {
  fmt::print(
      "RMSE of fingertips (* involved), reach and aperture in mm; widest aperture recorded "
      "and reproduced in mm, and when (of T)\n");
  fmt::print("{:<18} {:<9} {:>6} {:>7} {:>7} {:>7} {:>7} {:>6} {:>6} {:>13} {:>13}\n",
             "demonstration", "profile", "thumb", "index", "middle", "ring", "pinkie", "reach",
             "apert.", "widest", "at");
  for (int n = 1; n < argc; ++n) {
    const std::string argument = argv[n];
    const auto equals = argument.find('=');
    if (equals == std::string::npos) {
      fmt::print(stderr, "'{}' is not TYPE=DEMO.csv\n", argument);
      return 2;
    }
    const std::string path = argument.substr(equals + 1);
    const Demonstration shown = ReadDemonstration(path);
    for (const char* profile : {"human", "paper", "unforced"}) {
      LearnOptions options;
      options.type = argument.substr(0, equals);
      options.profile = profile;
      PrintRow(std::filesystem::path(path).stem().string(), profile, LearnGrasp(shown, options));
    }
  }
  return 0;
}

}  // namespace
}  // namespace springgrasp

int main(int argc, char** argv) { return StatisticsMain(argc, argv, springgrasp::Main); }
