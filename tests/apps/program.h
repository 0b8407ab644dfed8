// Runs the built program as a user would.
#pragma once

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace springgrasp {

struct ProgramResult {
  int exit_code = -1;
  std::string out, err;
};

// `command` goes through the shell, in `folder`; "springgrasp" stands for the built program.
inline ProgramResult RunProgram(const std::string& command, const std::string& folder) {
  const std::string script = "springgrasp() { '" SPRINGGRASP_PROGRAM "' \"$@\"; }; cd '" + folder +
                             "' && { " + command + "\n } 2>'" + folder + "/.stderr'";
  ProgramResult result;
  FILE* pipe = popen(script.c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    result.out.append(buffer.data(), n);
  }
  result.exit_code = WEXITSTATUS(pclose(pipe));
  if (FILE* file = std::fopen((folder + "/.stderr").c_str(), "r")) {
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), file)) {
      result.err.append(buffer.data(), n);
    }
    std::fclose(file);
    std::remove((folder + "/.stderr").c_str());
  }
  return result;
}

}  // namespace springgrasp
