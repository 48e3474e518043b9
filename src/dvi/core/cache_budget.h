#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <type_traits>
#include <unordered_map>
#include <utility>

namespace dvi {

/// Returns the memory that an item occupies, for CacheBudget: its `bytes()` if it has that member, otherwise the pixels of an
/// image, the items of a container, or the object itself. A type that owns memory in another way needs `bytes()`.
template <class T>
std::size_t bytes_of(const T& item) {
  if constexpr (requires { item.bytes(); }) {
    return item.bytes();
  } else if constexpr (requires { item.total() * item.elemSize(); }) {
    return item.total() * item.elemSize();
  } else if constexpr (requires { item.capacity(); }) {
    using Item = typename T::value_type;
    std::size_t bytes = (item.capacity() - item.size()) * sizeof(Item);
    if constexpr (std::is_trivially_destructible_v<Item>)
      bytes += item.size() * sizeof(Item);
    else
      for (const Item& each : item) bytes += sizeof(Item) + bytes_of(each);
    return bytes;
  } else {
    static_assert(std::is_trivially_destructible_v<T>, "give the type a bytes()");
    return sizeof(T);
  }
}

/// Caches the items of many sequences within a common bound. Beyond it, items with the lowest cost per byte are dropped first
/// and, among equals, the least recently used: GreedyDual-Size (Cao and Irani, 1997). The rank of an item is its cost per byte
/// plus the rank of the last dropped item at its last use, so that every unused item is dropped eventually. Each operation
/// takes logarithmic time. Thread-safe.
class CacheBudget {
 public:
  using Value = std::shared_ptr<const void>;
  /// A cache, and the index of one of its items.
  using Key = std::pair<const void*, std::size_t>;

  explicit CacheBudget(std::size_t bound) : bound_(bound) {}

  /// Returns the budget that all caches of the process share unless they are given another one.
  static const std::shared_ptr<CacheBudget>& of_process();

  /// Sets the bound in bytes, and drops items that exceed it.
  void set_bound(std::size_t bound);
  /// Sets the memory of the process, in bytes, above which the heap is trimmed more often; 0: none. Dropped items leave holes
  /// in the heap, which is trimmed from time to time.
  void set_trimmed_above(std::size_t resident) { trimmed_above_ = resident; }
  /// Returns the bound, including a loan.
  std::size_t bound() const;
  std::size_t used() const;

  /// Returns the item if it is cached, and marks it as used.
  Value find(const Key& key);
  /// Caches a new item. The newest item is never dropped, whatever its size. `cost` is that of making the item, in any unit.
  void keep(const Key& key, Value value, std::size_t size, double cost);
  /// Drops all items of a cache with `count` items.
  void forget(const void* cache, std::size_t count);

  /// Raises the bound by `bytes` during its lifetime: memory that is free for now. While one loan lives, others have no effect.
  class Loan {
   public:
    Loan(std::shared_ptr<CacheBudget> budget, std::size_t bytes);
    ~Loan();
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

   private:
    std::shared_ptr<CacheBudget> budget_;  // null if another loan lives
  };

 private:
  struct KeyHash {
    std::size_t operator()(const Key& key) const {
      return std::hash<const void*>()(key.first) ^ (key.second * std::size_t{0x9E3779B97F4A7C15});
    }
  };
  struct Item {
    Key key;
    Value value;
    std::size_t size = 0;
    double cost_per_byte = 0;
  };
  using Items = std::multimap<double, Item>;  // by rank; for equal ranks, the older item comes first

  bool take_loan(std::size_t bytes);
  void return_loan();
  Items::iterator drop(Items::iterator item, Items& dropped);
  void drop_beyond_bound(Items& dropped);
  void destroy(Items dropped);
  bool is_trim_due() const;

  mutable std::mutex mutex_;
  std::size_t bound_, loan_ = 0, used_ = 0;
  std::atomic<std::size_t> trimmed_above_ = 0;
  std::atomic<std::size_t> freed_ = 0;  // bytes dropped since the heap was trimmed
  double dropped_rank_ = 0;             // the highest rank of dropped items
  Key newest_;
  Items items_;
  std::unordered_map<Key, Items::iterator, KeyHash> by_key_;
};

}  // namespace dvi
