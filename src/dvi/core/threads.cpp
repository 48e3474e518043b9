#include "dvi/core/threads.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

#include "dvi/core/progress.h"
#include "dvi/core/work_memory.h"

namespace dvi {
namespace {

/// CPU seconds of other threads for tasks of this thread, less those of this thread for tasks of others.
thread_local double from_helpers = 0;

/// States to the thread sanitizer what TBB guarantees, because Debian's TBB is not instrumented: what happened before a sender
/// is destroyed is known after receive().
class Handover {
 public:
#ifdef __SANITIZE_THREAD__
  Handover() { __tsan_release(address()); }
  void send() const { __tsan_release(address()); }
  void receive() const { __tsan_acquire(address()); }

 private:
  void* address() const { return const_cast<char*>(&place_); }
  char place_ = 0;

 public:
#else
  void send() const {}
  void receive() const {}
#endif
  class Sender {
   public:
    explicit Sender(const Handover& to) : to_(to) {}
    ~Sender() { to_.send(); }
    Sender(const Sender&) = delete;
    Sender& operator=(const Sender&) = delete;

   private:
    const Handover& to_;
  };
};

}  // namespace

struct ThreadLimit::Impl {
  explicit Impl(std::size_t count) : control(tbb::global_control::max_allowed_parallelism, count) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int count)
    : impl_(std::make_unique<Impl>(count > 0 ? static_cast<std::size_t>(count)
                                             : std::max(1U, std::thread::hardware_concurrency()))) {}
ThreadLimit::~ThreadLimit() = default;

int thread_count() { return static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)); }

double task_cpu_seconds() { return thread_cpu_seconds() + from_helpers; }

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  const Handover before, after;
  const std::thread::id caller = std::this_thread::get_id();
  std::atomic<double> helped = 0;
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    before.receive();
    const Handover::Sender ends(after);
    if (std::this_thread::get_id() == caller) return body(i);
    const double begun = task_cpu_seconds();
    body(i);
    const double spent = task_cpu_seconds() - begun;
    from_helpers -= spent;
    helped.fetch_add(spent);
  });
  from_helpers += helped;
  after.receive();
}

// The functions that TBB calls are not checked, because they read their captures before they can call receive().
#define DVI_UNCHECKED __attribute__((no_sanitize("thread")))

void run_pipeline(std::size_t count, const std::vector<PipelineStep>& steps, std::size_t bytes_per_item) {
  const Handover all;
  std::size_t next = 0;
  tbb::filter<void, std::size_t> chain = tbb::make_filter<void, std::size_t>(
      tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) DVI_UNCHECKED -> std::size_t {
        if (next < count) return next++;
        control.stop();
        return 0;
      });
  for (const PipelineStep& step : steps) {
    const bool any = step.order == PipelineStep::Order::any;
    const auto call = [&all, &step](std::size_t i) DVI_UNCHECKED -> std::size_t {
      all.receive();
      const Handover::Sender ends(all);
      // A thread that waits inside must not begin another item: it would delay this one.
      tbb::this_task_arena::isolate([&] { step.call(i); });
      return i;
    };
    chain = chain & tbb::make_filter<std::size_t, std::size_t>(
                        any ? tbb::filter_mode::parallel : tbb::filter_mode::serial_in_order, call);
  }
  const auto max_items = static_cast<std::size_t>(thread_count() + std::max(2, thread_count() / 4));
  tbb::parallel_pipeline(WorkMemory::of_process()->count_items(bytes_per_item, max_items),
                         chain & tbb::make_filter<std::size_t, void>(tbb::filter_mode::parallel, [](std::size_t) {}));
  all.receive();
}

void for_blocks(std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& body,
                std::size_t bytes_per_item) {
  const std::size_t block = WorkMemory::of_process()->count_items(bytes_per_item, static_cast<std::size_t>(thread_count()));
  for (std::size_t first = 0; first < count; first += block) body(first, std::min(first + block, count));
}

void parallel_in_order(std::size_t count, const std::function<void(std::size_t)>& body, std::size_t bytes_per_item) {
  const auto process = [&](std::size_t first, std::size_t last) {
    parallel_for(last - first, [&](std::size_t i) { body(first + i); });
  };
  for_blocks(count, process, bytes_per_item);
}

}  // namespace dvi
