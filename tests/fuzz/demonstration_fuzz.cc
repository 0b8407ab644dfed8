// Any bytes as a demonstration: refused by Error in one line, or read; what was read is written
// and read again to the same bytes.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "base/error.h"
#include "demonstration/demonstration.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace springgrasp;
  const std::string text(data, data + size);
  Demonstration first;
  try {
    first = ParseDemonstration(text, "demo.csv");
  } catch (const Error& e) {
    const std::string message = e.what();
    if (message.empty() || message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  // An object's pose goes through a matrix and may lose its last digit.
  first.object.reset();
  const std::string written = FormatDemonstration(first);
  // An Error here is a finding: it leaves this function and ends the run.
  if (FormatDemonstration(ParseDemonstration(written, "again.csv")) != written) std::abort();
  return 0;
}
