#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <unordered_map>
#include <utility>

#include <tbb/task_arena.h>

namespace dvi {

/// A sequence whose items are made on demand and kept, least recently used first out, up to `capacity` of them.
/// Copies share the cache. Safe to read from many threads; an item is made by one of them while the others wait.
template <class T>
class Lazy {
 public:
  using Make = std::function<T(std::size_t)>;

  Lazy() = default;
  Lazy(std::size_t count, std::size_t capacity, Make make)
      : state_(std::make_shared<State>(count, std::max<std::size_t>(capacity, 1), std::move(make))) {}

  std::size_t size() const { return state_ ? state_->count : 0; }
  bool empty() const { return size() == 0; }

  /// The item; stays alive as long as the caller holds it, cached or not. Rethrows what making it threw.
  std::shared_ptr<const T> operator[](std::size_t i) const {
    State& s = *state_;
    std::unique_lock lock(s.mutex);
    s.changed.wait(lock, [&] { return !s.in_work.contains(i); });
    if (const auto it = s.items.find(i); it != s.items.end()) {
      it->second.used = ++s.clock;
      return it->second.value;
    }
    s.in_work.insert(i);
    lock.unlock();
    std::shared_ptr<const T> value;
    try {
      // Isolated, so that a thread waiting inside does not pick up a task that waits for this very item.
      tbb::this_task_arena::isolate([&] { value = std::make_shared<const T>(s.make(i)); });
    } catch (...) {
      lock.lock();
      s.in_work.erase(i);
      s.changed.notify_all();
      throw;
    }
    lock.lock();
    s.in_work.erase(i);
    s.items[i] = {value, ++s.clock};
    s.evict();
    s.changed.notify_all();
    return value;
  }

 private:
  struct Item {
    std::shared_ptr<const T> value;
    std::uint64_t used = 0;
  };
  struct State {
    State(std::size_t n, std::size_t keep, Make m) : count(n), capacity(keep), make(std::move(m)) {}
    void evict() {
      while (items.size() > capacity) {
        auto oldest = items.begin();
        for (auto it = items.begin(); it != items.end(); ++it)
          if (it->second.used < oldest->second.used) oldest = it;
        items.erase(oldest);
      }
    }
    std::size_t count, capacity;
    Make make;
    std::mutex mutex;
    std::condition_variable changed;
    std::set<std::size_t> in_work;
    std::unordered_map<std::size_t, Item> items;
    std::uint64_t clock = 0;
  };
  std::shared_ptr<State> state_;
};

}  // namespace dvi
