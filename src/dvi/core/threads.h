#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace dvi {

/// Limits the whole process to `count` threads during its lifetime; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int count);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the maximum number of threads.
int thread_count();

/// Calls body(i) for i in [0, count), in any order, on all threads. Each call must write its own output only. The caller merges
/// the outputs in index order, so that no result depends on scheduling.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Calls body(first, last) for consecutive blocks of thread_count() indices of [0, count), of which the last one may be
/// shorter. It serves items that are made in parallel and then merged in order, without memory for all of them.
void for_blocks(std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& body);

/// Does the same as parallel_for(), but processes [0, count) from front to back, so that data shared by neighbors stays in a
/// bounded cache.
void parallel_in_order(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace dvi
