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

/// Bytes that an item occupies, for CacheBudget: what its `bytes()` says, else the pixels of an image, the items of a
/// container, the object itself. A type that owns memory in any other way needs `bytes()`.
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

/// Keeps items of many caches as long as their sizes together stay within a bound. Beyond it, what is cheap to make again for
/// its size goes first, and of what costs as much, what was used least recently: GreedyDual-Size (Cao and Irani, 1997). An item
/// ranks by its cost per byte plus the rank of what was dropped last, at each use anew, so that none stays for ever. Every
/// operation takes logarithmic time. Safe to use from several threads.
class CacheBudget {
 public:
  using Value = std::shared_ptr<const void>;

  explicit CacheBudget(std::size_t bound) : bound_(bound) {}

  /// The budget that all caches of the process share unless they are given another.
  static const std::shared_ptr<CacheBudget>& of_process();

  /// Drops items if that is less than what is kept.
  void set_bound(std::size_t bound);
  std::size_t used() const;

  /// The item if it is kept; it counts as used from now on.
  Value find(const void* cache, std::size_t index);
  /// Keeps an item that is not kept yet. The newest item is never dropped, whatever its size. `cost`: of making it, in any
  /// unit.
  void keep(const void* cache, std::size_t index, Value value, std::size_t size, double cost);
  /// Drops what it keeps of a cache with so many items.
  void forget(const void* cache, std::size_t count);

 private:
  using Key = std::pair<const void*, std::size_t>;
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
  using Items = std::multimap<double, Item>;  // by rank, the older first of those that rank alike

  Items::iterator drop(Items::iterator item, Items& dropped);
  void drop_beyond_bound(Items& dropped);
  void destroy(Items dropped);

  mutable std::mutex mutex_;
  std::size_t bound_, used_ = 0;
  std::atomic<std::size_t> freed_ = 0;  // bytes since the heap was trimmed
  double dropped_rank_ = 0;             // the highest
  Key newest_;
  Items items_;
  std::unordered_map<Key, Items::iterator, KeyHash> by_key_;
};

}  // namespace dvi
