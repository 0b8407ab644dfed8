// Runs a fuzz target without libFuzzer: every seed as it is, then mutations of them.
//   TARGET SEED_FOLDER COUNT [RANDOM_SEED]     the same arguments give the same inputs
//   TARGET FILE...                             each file once, to look at a finding
// A crash leaves the input in crash_<TARGET>.
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargest = 1 << 14;  // bytes

// Words that readers of numbers, YAML and CSV may stumble over.
const std::vector<std::string> kWords = {"0",
                                         "-1",
                                         "1e308",
                                         "1e-320",
                                         "nan",
                                         ".inf",
                                         "-.Inf",
                                         "+",
                                         "1e",
                                         "99999999999",
                                         "-0",
                                         "2147483647",
                                         "&a ",
                                         "*a",
                                         "!!",
                                         "%YAML:1.0",
                                         "---\n",
                                         "...\n",
                                         "[",
                                         "]",
                                         "{",
                                         "}",
                                         ":",
                                         "- ",
                                         "? ",
                                         "|\n",
                                         "\"",
                                         "'",
                                         "\t",
                                         "\r\n",
                                         "\n",
                                         ",",
                                         ";",
                                         "#",
                                         "# frame: ",
                                         "# up: ",
                                         "# object: box:0.1x0.1x0.1; pose: 0 0 0 1 0 0 0",
                                         "rows: ",
                                         "cols: ",
                                         "data: ",
                                         "dt: ",
                                         "<<: *a",
                                         "\xEF\xBB\xBF",
                                         "\xFF",
                                         std::string(1, '\0'),
                                         "pose:",
                                         "marker_offset: "};

std::string Read(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class Mutator {
 public:
  Mutator(std::vector<std::string> seeds, std::uint64_t seed)
      : seeds_(std::move(seeds)), engine_(seed) {}

  std::string Next() {
    std::string text = seeds_[Below(seeds_.size())];
    for (std::size_t steps = 1 + Below(6); steps > 0; --steps) Step(text);
    text.resize(std::min(text.size(), kLargest));
    return text;
  }

 private:
  // std::uniform_int_distribution differs between libraries.
  std::size_t Below(std::size_t n) { return n == 0 ? 0 : engine_() % n; }

  void Step(std::string& text) {
    const std::size_t at = Below(text.size() + 1);
    const std::size_t length = std::min(Below(1 + Below(60)), text.size() - at);
    switch (Below(7)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(Below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, kWords[Below(kWords.size())]);
        break;
      case 3:
        text.replace(at, length, kWords[Below(kWords.size())]);
        break;
      case 4:
        text.insert(Below(text.size() + 1), text.substr(at, length));
        break;
      case 5:
        text.resize(at);
        break;
      default: {  // the end of another seed
        const std::string& other = seeds_[Below(seeds_.size())];
        text.replace(at, std::string::npos, other.substr(Below(other.size() + 1)));
      }
    }
  }

  std::vector<std::string> seeds_;
  std::mt19937_64 engine_;
};

std::string g_input, g_crash_file;

// Async-signal-safe enough for a program that ends here.
void KeepInput() {
  if (FILE* file = std::fopen(g_crash_file.c_str(), "wb")) {
    std::fwrite(g_input.data(), 1, g_input.size(), file);
    std::fclose(file);
  }
}

void OnSignal(int number) {
  KeepInput();
  std::signal(number, SIG_DFL);
  std::raise(number);
}

bool Try(std::string input) {
  g_input = std::move(input);
  try {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(g_input.data()), g_input.size());
    return true;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "exception: %s\n", e.what());
    KeepInput();
    return false;
  }
}

}  // namespace

int main(int argc, char** argv) {
  g_crash_file = "crash_" + fs::path(argv[0]).filename().string();
  std::signal(SIGSEGV, OnSignal);
  std::signal(SIGABRT, OnSignal);
  if (argc < 2 || !fs::is_directory(argv[1])) {
    for (int i = 1; i < argc; ++i) {
      if (!Try(Read(argv[i]))) return 1;
    }
    std::printf("%d files\n", argc - 1);
    return argc < 2;
  }
  std::vector<fs::path> paths(fs::directory_iterator(argv[1]), {});
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> seeds;
  for (const fs::path& path : paths) {
    seeds.push_back(Read(path));
    if (!Try(seeds.back())) return 1;
  }
  const long count = argc > 2 ? std::atol(argv[2]) : 1000;
  Mutator mutator(seeds, argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
  for (long i = 0; i < count; ++i) {
    if (!Try(mutator.Next())) return 1;
  }
  std::printf("%zu seeds and %ld mutations of them\n", seeds.size(), count);
  return seeds.empty();
}
