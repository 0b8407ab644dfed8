// Confusion matrix of recognition with the shipped library: synthesised demonstrations of varied
// size, speed and way, 1 mm noise, none of which the library was learned from.
//   recognition_statistics [DRAWS PER TYPE]
#include <fmt/format.h>

#include <cstdlib>
#include <map>

#include "base/error.h"
#include "experiment/synthesised_demonstration.h"
#include "grasp/library.h"

int main(int argc, char** argv) {
  using namespace springgrasp;
  const int draws = argc > 1 ? std::atoi(argv[1]) : 50;
  const std::vector<LibraryEntry> library = ReadLibrary(ShippedLibrary());
  const std::vector<std::string> types = {"pinch", "tripod", "power", "lateral"};
  fmt::print("{:<10}", "shown");
  for (const std::string& type : types) fmt::print("{:>9}", type);
  fmt::print("   not held\n");
  int right = 0, all = 0;
  for (const std::string& type : types) {
    std::map<std::string, int> taken;
    int skipped = 0;
    for (int draw = 0; draw < draws; ++draw) {
      RandomEngine engine = MakeStream(6001, static_cast<std::uint64_t>(draw), type);
      const Shape shape = RandomObjectFor(type, engine);
      try {
        const Demonstration shown = SynthesisedDemonstration(type, shape, 0.001, engine);
        const std::string best = RecogniseGrasp(shown, library).front().type;
        ++taken[best];
        right += best == type;
        ++all;
      } catch (const Error&) {
        ++skipped;  // the hand cannot hold that object so
      }
    }
    fmt::print("{:<10}", type);
    for (const std::string& as : types) fmt::print("{:>9}", taken[as]);
    fmt::print("{:>11}\n", skipped);
    std::fflush(stdout);
  }
  fmt::print("right: {} of {} ({:.1f} %)\n", right, all, 100.0 * right / std::max(1, all));
}
