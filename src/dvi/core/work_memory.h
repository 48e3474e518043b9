#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

namespace dvi {

/// The memory for items in progress, such as frames that are being filled. Loops limit by it how many items they process at a
/// time. Thread-safe.
class WorkMemory {
 public:
  explicit WorkMemory(std::size_t bound) : bound_(bound) {}

  /// Returns the memory that all loops of the process share. It is unlimited until its bound is set.
  static const std::shared_ptr<WorkMemory>& of_process();

  /// Sets the bound in bytes for loops that begin later.
  void set_bound(std::size_t bound) { bound_ = bound; }
  std::size_t bound() const { return bound_; }

  /// Returns how many items of the given size fit: at least one, at most `max_items`.
  std::size_t count_items(std::size_t bytes_per_item, std::size_t max_items) const;

  /// Returns the memory that is free while `items` of the given size are in progress; 0 if their size is not known (0) or the
  /// memory is unlimited.
  std::size_t count_free(std::size_t bytes_per_item, std::size_t items) const;

 private:
  std::atomic<std::size_t> bound_;
};

}  // namespace dvi
