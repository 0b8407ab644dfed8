// Two stages of a chain at work at once: the first makes the next value while the second uses the
// last one.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace springgrasp {

// Calls `produce` on the calling thread (what it owns, a rendering context say, may be bound to
// that) and `consume` on another, which gets the values in order and nothing at the end. At most
// `ahead` values wait. Ends when `consume` has returned, even if not all was produced. Throws what
// either threw; of both, what `consume` did.
template <typename T>
void Pipelined(const std::function<std::optional<T>()>& produce,
               const std::function<void(const std::function<std::optional<T>()>&)>& consume,
               std::size_t ahead = 2) {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<T> waiting;
  bool all_produced = false, consumed = false;
  std::exception_ptr failed_production, failed_consumption;

  const std::function<std::optional<T>()> next = [&]() -> std::optional<T> {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return !waiting.empty() || all_produced; });
    if (waiting.empty()) return std::nullopt;
    std::optional<T> value(std::move(waiting.front()));
    waiting.pop_front();
    changed.notify_all();
    return value;
  };
  std::thread consumer([&] {
    try {
      consume(next);
    } catch (...) {
      failed_consumption = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    consumed = true;
    changed.notify_all();
  });
  try {
    while (true) {
      {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return waiting.size() < ahead || consumed; });
        if (consumed) break;
      }
      std::optional<T> value = produce();
      const std::lock_guard lock(mutex);
      if (!value) break;
      waiting.push_back(std::move(*value));
      changed.notify_all();
    }
  } catch (...) {
    failed_production = std::current_exception();
  }
  {
    const std::lock_guard lock(mutex);
    all_produced = true;
    changed.notify_all();
  }
  consumer.join();
  if (failed_consumption) std::rethrow_exception(failed_consumption);
  if (failed_production) std::rethrow_exception(failed_production);
}

}  // namespace springgrasp
