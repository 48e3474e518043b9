#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <vector>

namespace dvi {

/// Returns TMPDIR, or /tmp if it is not set or empty. Throws std::filesystem::filesystem_error if it is not a folder.
std::filesystem::path find_temporary_folder();

/// Memory with a bound. Blocks beyond it are paged to unlinked temporary files, which disappear with the process; the system
/// keeps only the pages in use. Thread-safe.
class Scratch {
 public:
  /// Allocations beyond `bound` bytes throw InputError if `folder` has no space for them.
  explicit Scratch(std::size_t bound, std::filesystem::path folder = find_temporary_folder())
      : bound_(bound), folder_(std::move(folder)) {}

  /// Returns the scratch memory for the maps of the process.
  static const std::shared_ptr<Scratch>& of_process();

  /// Sets the bound in bytes for subsequent blocks.
  void set_bound(std::size_t bound);
  std::size_t bound() const;
  /// Returns the bytes that are not in temporary files.
  std::size_t in_memory() const;

  void* allocate(std::size_t bytes);
  void release(void* block, std::size_t bytes);

  /// Releases the pages of file-backed blocks from memory until they are next read.
  void page_out();
  /// Returns the bytes in temporary files.
  std::size_t on_disk() const;

 private:
  void* map_file(std::size_t bytes);

  mutable std::mutex mutex_;
  std::size_t bound_;
  const std::filesystem::path folder_;
  std::size_t in_memory_ = 0;
  std::map<void*, std::size_t> files_;  // size by address
};

/// Releases the pages of Scratch::of_process() from memory every 2^18 items of a loop over it.
inline void page_out_sometimes(std::size_t item) {
  constexpr std::size_t kItems = std::size_t{1} << 18;
  if ((item + 1) % kItems == 0) Scratch::of_process()->page_out();
}

/// Allocates the memory of standard containers in a Scratch, or in ordinary memory if there is none.
template <class T>
struct ScratchAllocator {
  using value_type = T;
  using propagate_on_container_copy_assignment = std::true_type;  // NOLINT(readability-identifier-naming)
  using propagate_on_container_move_assignment = std::true_type;  // NOLINT(readability-identifier-naming)
  using propagate_on_container_swap = std::true_type;             // NOLINT(readability-identifier-naming)

  ScratchAllocator(std::shared_ptr<Scratch> from = {}) : scratch(std::move(from)) {}  // NOLINT(google-explicit-constructor)
  template <class Other>
  ScratchAllocator(const ScratchAllocator<Other>& other) : scratch(other.scratch) {}  // NOLINT(google-explicit-constructor)

  T* allocate(std::size_t n) {
    return static_cast<T*>(scratch ? scratch->allocate(n * sizeof(T)) : ::operator new(n * sizeof(T)));
  }
  void deallocate(T* block, std::size_t n) { scratch ? scratch->release(block, n * sizeof(T)) : ::operator delete(block); }
  bool operator==(const ScratchAllocator& other) const { return scratch == other.scratch; }

  std::shared_ptr<Scratch> scratch;
};

template <class T>
using ScratchVector = std::vector<T, ScratchAllocator<T>>;

}  // namespace dvi
