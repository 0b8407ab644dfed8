// One value kept for whoever asks for the same again.
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace springgrasp {

// Keeps the last value made, by the text of all that it depends on.
template <typename T>
class LastValue {
 public:
  // The value of `key`: the kept one, or what `make()` returns. What it throws is passed on, and
  // nothing is kept. The reference holds until the next call.
  template <typename Make>
  const T& Get(const std::string& key, const Make& make) {
    if (value_ && key == key_) return *value_;
    value_.reset();
    value_.emplace(make());
    key_ = key;
    return *value_;
  }

 private:
  std::string key_;
  std::optional<T> value_;
};

}  // namespace springgrasp
