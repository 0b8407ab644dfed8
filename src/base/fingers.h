// The five fingers in the paper's order (Fig. 1), everywhere in files and code.
#pragma once

#include <array>
#include <string_view>

namespace springgrasp {

inline constexpr int kNumFingers = 5;
enum Finger : int { kThumb = 0, kIndex = 1, kMiddle = 2, kRing = 3, kPinkie = 4 };

inline constexpr std::array<std::string_view, kNumFingers> kFingerNames = {
    "thumb", "index", "middle", "ring", "pinkie"};

template <typename T>
using PerFinger = std::array<T, kNumFingers>;

}  // namespace springgrasp
