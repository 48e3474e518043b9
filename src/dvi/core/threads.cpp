#include "dvi/core/threads.h"

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

#include "dvi/core/progress.h"
#include "dvi/core/task_trace.h"
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

/// A loop in the trace of the process, if there is one.
class TracedLoop {
 public:
  TracedLoop(std::size_t items, std::size_t limit, const std::string& steps) : trace_(TaskTrace::of_process()) {
    if (trace_ != nullptr) trace_->begin_loop(items, limit, steps);
  }
  ~TracedLoop() {
    if (trace_ != nullptr) trace_->end_loop();
  }
  TracedLoop(const TracedLoop&) = delete;
  TracedLoop& operator=(const TracedLoop&) = delete;

 private:
  TaskTrace* trace_;
};

/// Counts the CPU seconds of other threads for a loop as those of the thread that calls it.
class HelpedLoop {
 public:
  HelpedLoop() = default;
  ~HelpedLoop() { from_helpers += helped_; }
  HelpedLoop(const HelpedLoop&) = delete;
  HelpedLoop& operator=(const HelpedLoop&) = delete;

  /// Calls task() on any thread.
  template <class Task>
  void call(const Task& task) {
    if (std::this_thread::get_id() == caller_) return task();
    const double begun = task_cpu_seconds();
    task();
    const double spent = task_cpu_seconds() - begun;
    from_helpers -= spent;
    helped_.fetch_add(spent);
  }

 private:
  const std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<double> helped_ = 0;
};

/// Returns how many items fit into memory; 0: any number.
std::size_t count_fitting(std::size_t bytes_per_item) {
  constexpr std::size_t kMost = 1'000'000;
  const std::size_t limit = WorkMemory::of_process()->count_items(bytes_per_item, kMost);
  return limit < kMost ? limit : 0;
}

/// A task in the trace of the process, if there is one.
class TracedTask {
 public:
  TracedTask(std::size_t item, std::size_t step) : trace_(TaskTrace::of_process()) {
    if (trace_ != nullptr) trace_->begin_task(item, step);
  }
  ~TracedTask() {
    if (trace_ != nullptr) trace_->end_task();
  }
  TracedTask(const TracedTask&) = delete;
  TracedTask& operator=(const TracedTask&) = delete;

 private:
  TaskTrace* trace_;
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

CacheBudget::Loan lend_free_memory(std::size_t bytes_per_item, std::size_t max_items) {
  const WorkMemory& work = *WorkMemory::of_process();
  return {CacheBudget::of_process(), work.count_free(bytes_per_item, work.count_items(bytes_per_item, max_items))};
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body) {
  const Handover before, after;
  HelpedLoop loop;
  const TracedLoop traced(count, 0, "a");
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    before.receive();
    const Handover::Sender ends(after);
    const TracedTask task(i, 0);
    loop.call([&] { body(i); });
  });
  after.receive();
}

// The functions that TBB calls are not checked, because they read their captures before they can call receive().
#define DVI_UNCHECKED __attribute__((no_sanitize("thread")))

namespace {

/// Does the same as run_pipeline(), with at most `max_items` items in progress.
void run_steps(std::size_t count, const std::vector<PipelineStep>& steps, std::size_t bytes_per_item, std::size_t max_items) {
  const Handover all;
  HelpedLoop loop;
  std::size_t next = 0;
  tbb::filter<void, std::size_t> chain = tbb::make_filter<void, std::size_t>(
      tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) DVI_UNCHECKED -> std::size_t {
        if (next < count) return next++;
        control.stop();
        return 0;
      });
  std::string orders;
  for (const PipelineStep& step : steps) {
    const std::size_t number = orders.size();
    orders += step.order == PipelineStep::Order::any ? 'a' : 'o';
    const bool any = step.order == PipelineStep::Order::any;
    const auto call = [&all, &loop, &step, number](std::size_t i) DVI_UNCHECKED -> std::size_t {
      all.receive();
      const Handover::Sender ends(all);
      const TracedTask task(i, number);
      // A thread that waits inside must not begin another item: it would delay this one.
      tbb::this_task_arena::isolate([&] { loop.call([&] { step.call(i); }); });
      return i;
    };
    chain = chain & tbb::make_filter<std::size_t, std::size_t>(
                        any ? tbb::filter_mode::parallel : tbb::filter_mode::serial_in_order, call);
  }
  const TracedLoop traced(count, count_fitting(bytes_per_item), orders);
  const CacheBudget::Loan loan = lend_free_memory(bytes_per_item, max_items);
  tbb::parallel_pipeline(WorkMemory::of_process()->count_items(bytes_per_item, max_items),
                         chain & tbb::make_filter<std::size_t, void>(tbb::filter_mode::parallel, [](std::size_t) {}));
  all.receive();
}

}  // namespace

void run_pipeline(std::size_t count, const std::vector<PipelineStep>& steps, std::size_t bytes_per_item) {
  const auto max_items = static_cast<std::size_t>(thread_count() + std::max(2, thread_count() / 4));
  run_steps(count, steps, bytes_per_item, max_items);
}

void for_blocks(std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& body,
                std::size_t bytes_per_item) {
  const std::size_t block = WorkMemory::of_process()->count_items(bytes_per_item, static_cast<std::size_t>(thread_count()));
  const CacheBudget::Loan loan = lend_free_memory(bytes_per_item, block);
  const TracedLoop traced(count, count_fitting(bytes_per_item), "b");
  for (std::size_t first = 0; first < count; first += block) {
    const TracedTask task(first, 0);
    body(first, std::min(first + block, count));
  }
}

void parallel_in_order(std::size_t count, const std::function<void(std::size_t)>& body, std::size_t bytes_per_item) {
  run_steps(count, {{PipelineStep::Order::any, body}}, bytes_per_item, static_cast<std::size_t>(thread_count()));
}

}  // namespace dvi
