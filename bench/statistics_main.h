// main() of programs that print a table.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <exception>

// Runs `print(argc, argv)`; an exception becomes one line on stderr and exit code 2.
template <typename F>
int StatisticsMain(int argc, char** argv, F&& print) {
  try {
    return print(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 2;
  }
}
