// What made a results directory: program, revision, libraries, machine, models.
#pragma once

#include <string>

namespace springgrasp {

// `key: value` lines. The revision is that of the build, "unknown" without git.
std::string DescribeProvenance();

// Hash of all files below models/, 16 hexadecimal digits.
std::string HashOfModels();

}  // namespace springgrasp
