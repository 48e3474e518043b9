#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace dvi {

/// Limits the whole process to `count` threads as long as it lives; 0 means all cores.
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

/// How many threads run at most.
int thread_count();

/// Calls body(i) for i in [0, count), in any order, on all threads. Each call must write its own output only: merging is
/// the caller's, in index order, so that no result depends on scheduling.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Calls body(first, last) for one block of thread_count() indices of [0, count) after the other, the last one shorter: for
/// what is made in parallel and then merged in order, without room for all of it.
void for_blocks(std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& body);

/// The same, but moving through [0, count) from front to back, so that what neighbors share stays in a bounded cache.
void parallel_in_order(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace dvi
