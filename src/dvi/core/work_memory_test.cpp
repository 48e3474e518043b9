#include "dvi/core/work_memory.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <limits>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/cache_budget.h"
#include "dvi/core/threads.h"

namespace dvi {
namespace {

constexpr std::size_t kItems = 40, kItemBytes = 100;

/// Changes the bound of the process's memory and restores it at the end.
struct WorkBound {
  explicit WorkBound(std::size_t bound) { WorkMemory::of_process()->set_bound(bound); }
  ~WorkBound() { WorkMemory::of_process()->set_bound(before); }
  WorkBound(const WorkBound&) = delete;
  WorkBound& operator=(const WorkBound&) = delete;
  const std::size_t before = WorkMemory::of_process()->bound();
};

/// Counts the items that are in progress at the same time.
class InProgress {
 public:
  void begin() {
    const int now = ++count_;
    for (int most = most_; most < now && !most_.compare_exchange_weak(most, now);) {
    }
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  void end() { --count_; }
  int most() const { return most_; }

 private:
  std::atomic<int> count_ = 0, most_ = 0;
};

TEST(WorkMemory, CountsTheItemsThatFit) {
  const WorkMemory memory(1000);
  EXPECT_EQ(memory.count_items(100, 64), 10U);
  EXPECT_EQ(memory.count_items(100, 4), 4U);
  EXPECT_EQ(memory.count_items(300, 64), 3U);
  EXPECT_EQ(memory.count_items(2000, 64), 1U);
  EXPECT_EQ(memory.count_items(0, 64), 64U);
}

TEST(WorkMemory, CountsWhatItemsLeaveFree) {
  const WorkMemory memory(1000);
  EXPECT_EQ(memory.count_free(100, 3), 700U);
  EXPECT_EQ(memory.count_free(600, 2), 0U);
  EXPECT_EQ(memory.count_free(0, 3), 0U);
  EXPECT_EQ(WorkMemory(std::numeric_limits<std::size_t>::max()).count_free(100, 3), 0U);
}

TEST(WorkMemory, CachesUseWhatALoopLeavesFree) {
  const ThreadLimit two(2);
  const WorkBound bound(5 * kItemBytes);
  const std::shared_ptr<CacheBudget>& caches = CacheBudget::of_process();
  const std::size_t before = caches->bound();
  std::size_t in_loop = 0, nested = 0;
  parallel_in_order(
      1,
      [&](std::size_t) {
        in_loop = caches->bound();
        parallel_in_order(1, [&](std::size_t) { nested = caches->bound(); }, kItemBytes);
      },
      kItemBytes);
  EXPECT_EQ(in_loop, before + 3 * kItemBytes);
  EXPECT_EQ(nested, in_loop);
  EXPECT_EQ(caches->bound(), before);
  parallel_in_order(1, [&](std::size_t) { in_loop = caches->bound(); });
  EXPECT_EQ(in_loop, before);
}

TEST(WorkMemory, LimitsTheItemsOfAPipeline) {
  const ThreadLimit eight(8);
  for (const int fit : {1, 3}) {
    const WorkBound bound(static_cast<std::size_t>(fit) * kItemBytes);
    InProgress items;
    std::vector<std::size_t> used;
    run_pipeline(kItems,
                 {{PipelineStep::Order::any, [&](std::size_t) { items.begin(); }},
                  {PipelineStep::Order::ascending,
                   [&](std::size_t i) {
                     used.push_back(i);
                     items.end();
                   }}},
                 kItemBytes);
    EXPECT_LE(items.most(), fit);
    EXPECT_EQ(used.size(), kItems);
    EXPECT_TRUE(std::is_sorted(used.begin(), used.end()));
  }
}

TEST(WorkMemory, LimitsTheItemsOfALoop) {
  const ThreadLimit eight(8);
  const WorkBound bound(2 * kItemBytes);
  InProgress items;
  std::atomic<std::size_t> done = 0;
  const auto process = [&](std::size_t) {
    items.begin();
    ++done;
    items.end();
  };
  parallel_in_order(kItems, process, kItemBytes);
  EXPECT_LE(items.most(), 2);
  EXPECT_EQ(done, kItems);
}

}  // namespace
}  // namespace dvi
