#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include <tbb/task_arena.h>

#include "dvi/core/cache_budget.h"
#include "dvi/core/threads.h"

namespace dvi {

/// A sequence whose items are made on demand and cached within the budget that all sequences share; expensive items are kept
/// longer. Copies share the items. Thread-safe: one thread makes an item while the others wait for it.
template <class T>
class Lazy {
 public:
  using Make = std::function<T(std::size_t)>;
  using Find = std::function<std::shared_ptr<const T>(std::size_t)>;

  Lazy() = default;
  Lazy(std::size_t count, Make make)
      : state_(std::make_shared<State>(count, std::move(make), CacheBudget::of_process(),
                                       [](const T& item) { return bytes_of(item); })) {}
  /// Makes a sequence with a cache of its own, which keeps the `capacity` last used items of any size.
  Lazy(std::size_t count, std::size_t capacity, Make make)
      : state_(std::make_shared<State>(count, std::move(make),
                                       std::make_shared<CacheBudget>(std::max<std::size_t>(capacity, 1)),
                                       [](const T&) { return std::size_t{1}; })) {
    state_->alike = true;
  }
  /// Makes a sequence of items that are cached elsewhere: `find` is called for each access.
  static Lazy through(std::size_t count, Find find) {
    Lazy out(count, 1, nullptr);
    out.state_->find = std::move(find);
    return out;
  }

  std::size_t size() const { return state_ ? state_->count : 0; }
  bool empty() const { return size() == 0; }

  /// Returns an item, which stays alive as long as the caller holds it. Rethrows exceptions of its making.
  std::shared_ptr<const T> operator[](std::size_t i) const { return get(i, true); }
  /// Returns the same, or null if another thread is making the item.
  std::shared_ptr<const T> get_unless_in_work(std::size_t i) const { return get(i, false); }

 private:
  std::shared_ptr<const T> get(std::size_t i, bool waits) const {
    State& s = *state_;
    if (s.find) return s.find(i);
    std::unique_lock lock(s.mutex);
    if (!waits && s.in_work.contains(i)) return nullptr;
    s.changed.wait(lock, [&] { return !s.in_work.contains(i); });
    if (CacheBudget::Value kept = s.budget->find({&s, i})) return std::static_pointer_cast<const T>(std::move(kept));
    s.in_work.insert(i);
    lock.unlock();
    std::shared_ptr<const T> value;
    const auto start = std::chrono::steady_clock::now();
    try {
      // Isolation prevents a thread that waits inside from starting a task that waits for this item.
      tbb::this_task_arena::isolate([&] { value = std::make_shared<const T>(s.make(i)); });
    } catch (...) {
      lock.lock();
      s.in_work.erase(i);
      s.changed.notify_all();
      throw;
    }
    s.budget->keep({&s, i}, value, s.size_of(*value), s.alike ? 1 : seconds_since(start));
    lock.lock();
    s.in_work.erase(i);
    s.changed.notify_all();
    return value;
  }

  // The minimum is a millisecond, because shorter times depend on the machine rather than on the work.
  static double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::max(1e-3, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }

  struct State {
    State(std::size_t n, Make m, std::shared_ptr<CacheBudget> b, std::function<std::size_t(const T&)> size)
        : count(n), make(std::move(m)), budget(std::move(b)), size_of(std::move(size)) {}
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() { budget->forget(this, count); }

    std::size_t count;
    Make make;
    Find find;
    std::shared_ptr<CacheBudget> budget;
    std::function<std::size_t(const T&)> size_of;
    bool alike = false;  // all items have the same cost
    std::mutex mutex;
    std::condition_variable changed;
    std::set<std::size_t> in_work;
  };
  std::shared_ptr<State> state_;
};

/// Calls body(k, items[numbers[k]]) for each k, in any order, on all threads. Items that other threads are making come last, so
/// that several callers that need the same items share their making instead of waiting for each other at each of them.
template <class T, class Body>
void for_each_item(const Lazy<T>& items, const std::vector<std::size_t>& numbers, const Body& body) {
  std::vector<char> is_in_work(numbers.size(), 0);
  parallel_for(numbers.size(), [&](std::size_t k) {
    if (std::shared_ptr<const T> item = items.get_unless_in_work(numbers[k]))
      body(k, std::move(item));
    else
      is_in_work[k] = 1;
  });
  std::vector<std::size_t> left;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (is_in_work[k] != 0) left.push_back(k);
  if (!left.empty()) parallel_for(left.size(), [&](std::size_t n) { body(left[n], items[numbers[left[n]]]); });
}

}  // namespace dvi
