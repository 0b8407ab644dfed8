#include "base/random.h"

#include <cmath>
#include <numbers>

namespace springgrasp {

std::uint64_t HashText(std::string_view text, std::uint64_t basis) {
  std::uint64_t hash = basis;
  for (const char c : text) {
    hash ^= static_cast<unsigned char>(c);
    hash *= 0x100000001b3ULL;
  }
  return hash;
}

RandomEngine MakeStream(std::uint64_t experiment_seed, std::uint64_t repetition,
                        std::string_view stream) {
  const std::uint64_t name = HashText(stream);
  std::seed_seq seed{static_cast<std::uint32_t>(experiment_seed),
                     static_cast<std::uint32_t>(experiment_seed >> 32),
                     static_cast<std::uint32_t>(repetition),
                     static_cast<std::uint32_t>(repetition >> 32),
                     static_cast<std::uint32_t>(name),
                     static_cast<std::uint32_t>(name >> 32)};
  return RandomEngine(seed);
}

double Uniform01(RandomEngine& engine) { return static_cast<double>(engine() >> 11) * 0x1.0p-53; }

double Uniform(RandomEngine& engine, double lower, double upper) {
  return lower + (upper - lower) * Uniform01(engine);
}

double Normal(RandomEngine& engine) {
  // Box-Muller; 1 - u avoids log(0).
  const double u = 1.0 - Uniform01(engine);
  const double v = Uniform01(engine);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace springgrasp
