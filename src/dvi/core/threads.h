#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "dvi/core/cache_budget.h"

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

/// Returns the CPU seconds of the calling thread, with those of other threads for its loops: the cost of a task, however many
/// threads share it.
double task_cpu_seconds();

/// Calls body(i) for i in [0, count), in any order, on all threads. Each call must write its own output only. The caller merges
/// the outputs in index order, so that no result depends on scheduling.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

/// Lets the caches of the process use, during the lifetime of the result, the part of WorkMemory::of_process() that up to
/// `max_items` items in progress leave free, if each takes `bytes_per_item`. Loops that limit their items by memory do so
/// themselves; a function that calls several of them keeps the caches from being emptied in between.
CacheBudget::Loan lend_free_memory(std::size_t bytes_per_item, std::size_t max_items);

/// Calls body(first, last) for consecutive blocks of thread_count() indices of [0, count), of which the last one may be
/// shorter. It serves items that are made in parallel and then merged in order, without memory for all of them. Blocks are
/// shorter if each item takes `bytes_per_item` and WorkMemory::of_process() has too little memory.
void for_blocks(std::size_t count, const std::function<void(std::size_t first, std::size_t last)>& body,
                std::size_t bytes_per_item = 0);

/// Does the same as parallel_for(), but begins the items in ascending order, so that data shared by neighbors stays in a
/// bounded cache. At most thread_count() items are in progress, and fewer if each takes `bytes_per_item` and
/// WorkMemory::of_process() has too little memory.
void parallel_in_order(std::size_t count, const std::function<void(std::size_t)>& body, std::size_t bytes_per_item = 0);

/// A step of a pipeline, called with the number of an item.
struct PipelineStep {
  enum class Order {
    any,        ///< Called for several items at a time.
    ascending,  ///< Called for one item at a time, in the order of their numbers.
  };
  Order order = Order::any;
  std::function<void(std::size_t)> call;
};

/// Calls the steps one after another for each item of [0, count). Different steps of different items run at the same time, but
/// the number of items that have begun and not finished exceeds thread_count() by a few only, so that memory is limited. It is
/// smaller, but at least one, if each item takes `bytes_per_item` and WorkMemory::of_process() has too little memory.
void run_pipeline(std::size_t count, const std::vector<PipelineStep>& steps, std::size_t bytes_per_item = 0);

/// Calls make(i) for i in [0, count) on all threads, and use(i, result of make) in order, one at a time, while others are made.
/// The number of items in progress is limited as by run_pipeline().
template <class Make, class Use>
void make_and_use(std::size_t count, const Make& make, const Use& use, std::size_t bytes_per_item = 0) {
  std::vector<std::optional<std::invoke_result_t<Make, std::size_t>>> made(count);
  run_pipeline(count,
               {{PipelineStep::Order::any, [&](std::size_t i) { made[i].emplace(make(i)); }},
                {PipelineStep::Order::ascending,
                 [&](std::size_t i) {
                   use(i, std::move(*made[i]));
                   made[i].reset();
                 }}},
               bytes_per_item);
}

}  // namespace dvi
