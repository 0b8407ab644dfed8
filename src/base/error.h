// One exception type for everything a user can mend: bad input, impossible requests.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace springgrasp {

// Carries one clear line: what was asked, what was found, what would be valid, file and line.
// The program prints it and exits with 2 (bad input).
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A file could not be written: the disk is full, the folder shut. Not the fault of what was to be
// written, which may be tried again.
class NotWritten : public Error {
 public:
  using Error::Error;
};

// Throws Error with a formatted message.
template <typename... Args>
[[noreturn]] void Fail(fmt::format_string<Args...> format, Args&&... args) {
  throw Error(fmt::format(format, std::forward<Args>(args)...));
}

// Throws Error with a formatted message unless `condition` holds.
template <typename... Args>
void ThrowUnless(bool condition, fmt::format_string<Args...> format, Args&&... args) {
  if (!condition) throw Error(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace springgrasp
