// Seeded random streams. Engines are passed in; there is no global one.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>

namespace springgrasp {

using RandomEngine = std::mt19937_64;

// 64-bit FNV-1a hash of a text; the same on every machine.
std::uint64_t HashText(std::string_view text, std::uint64_t basis = 0xcbf29ce484222325ULL);

// Engine of one named stream: hash(experiment seed, repetition, stream name). Conditions that
// differ in a parameter share their draws, and adding a condition changes no other trial.
RandomEngine MakeStream(std::uint64_t experiment_seed, std::uint64_t repetition,
                        std::string_view stream);

// Draws that are equal on every standard library (std distributions are not).
double Uniform01(RandomEngine& engine);                            // in [0, 1)
double Uniform(RandomEngine& engine, double lower, double upper);  // in [lower, upper)
double Normal(RandomEngine& engine);                               // mean 0, deviation 1

}  // namespace springgrasp
