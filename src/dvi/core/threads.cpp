#include "dvi/core/threads.h"

#include <algorithm>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace dvi {

struct ThreadLimit::Impl {
  explicit Impl(std::size_t count) : control(tbb::global_control::max_allowed_parallelism, count) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int count)
    : impl_(std::make_unique<Impl>(count > 0 ? static_cast<std::size_t>(count)
                                             : std::max(1U, std::thread::hardware_concurrency()))) {}
ThreadLimit::~ThreadLimit() = default;

int thread_count() { return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)); }

#ifdef __SANITIZE_THREAD__
// Debian's TBB is not instrumented. The annotations state what TBB guarantees: each body begins after the code before the loop,
// and ends before the code after it. Bodies of one loop remain unordered.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  char before = 0, after = 0;
  struct Ends {
    char* after;
    ~Ends() { __tsan_release(after); }
  };
  __tsan_release(&before);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const Ends ends{&after};
    __tsan_acquire(&before);
    body(i);
  });
  __tsan_acquire(&after);
}
#else
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  tbb::parallel_for(std::size_t{0}, count, body);
}
#endif

void for_blocks(std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& body) {
  const auto block = static_cast<std::size_t>(thread_count());
  for (std::size_t first = 0; first < count; first += block) body(first, std::min(first + block, count));
}

void parallel_in_order(std::size_t count, const std::function<void(std::size_t)>& body) {
  for_blocks(count,
             [&](std::size_t first, std::size_t last) { parallel_for(last - first, [&](std::size_t i) { body(first + i); }); });
}

}  // namespace dvi
