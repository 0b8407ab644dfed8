#include "experiment/result_codec.h"

#include <cstdint>
#include <cstring>

#include "base/error.h"

namespace springgrasp {
namespace {

template <typename T>
void Put(std::string& bytes, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

void PutText(std::string& bytes, const std::string& text) {
  Put<std::uint32_t>(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

void PutMap(std::string& bytes, const std::map<std::string, double>& values) {
  Put<std::uint32_t>(bytes, static_cast<std::uint32_t>(values.size()));
  for (const auto& [name, value] : values) {
    PutText(bytes, name);
    Put(bytes, value);
  }
}

std::string_view Take(std::string_view& bytes, std::size_t n) {
  ThrowUnless(n <= bytes.size(), "a worker's result is cut short");
  const std::string_view head = bytes.substr(0, n);
  bytes.remove_prefix(n);
  return head;
}

template <typename T>
T Get(std::string_view& bytes) {
  T value;
  std::memcpy(&value, Take(bytes, sizeof(T)).data(), sizeof(T));
  return value;
}

std::string GetText(std::string_view& bytes) {
  const auto n = Get<std::uint32_t>(bytes);
  return std::string(Take(bytes, n));
}

std::map<std::string, double> GetMap(std::string_view& bytes) {
  std::map<std::string, double> values;
  for (auto n = Get<std::uint32_t>(bytes); n > 0; --n) {
    const std::string name = GetText(bytes);
    values[name] = Get<double>(bytes);
  }
  return values;
}

}  // namespace

std::string EncodeResult(const TrialResult& result) {
  std::string bytes;
  Put<std::uint32_t>(bytes, static_cast<std::uint32_t>(result.outcome));
  PutText(bytes, result.message);
  PutText(bytes, result.phase);
  PutMap(bytes, result.values);
  PutMap(bytes, result.wall_s);
  Put(bytes, result.not_written);
  return bytes;
}

TrialResult DecodeResult(std::string_view bytes) {
  TrialResult result;
  const auto outcome = Get<std::uint32_t>(bytes);
  ThrowUnless(outcome < kOutcomeNames.size(), "a worker's result has the outcome {}", outcome);
  result.outcome = static_cast<Outcome>(outcome);
  result.message = GetText(bytes);
  result.phase = GetText(bytes);
  result.values = GetMap(bytes);
  result.wall_s = GetMap(bytes);
  result.not_written = Get<bool>(bytes);
  ThrowUnless(bytes.empty(), "a worker's result has {} bytes too many", bytes.size());
  return result;
}

}  // namespace springgrasp
