#include "dvi/core/cache_budget.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/lazy.h"
#include "dvi/core/process_memory.h"
#include "dvi/core/random.h"
#include "dvi/core/threads.h"

namespace dvi {
namespace {

CacheBudget::Value number(int n) { return std::make_shared<const int>(n); }

struct Sized {
  std::size_t size = 0;
  std::size_t bytes() const { return size; }
};

/// Changes the bound of the process's budget and restores it at the end.
struct BoundOfProcess {
  explicit BoundOfProcess(std::size_t bound) { CacheBudget::of_process()->set_bound(bound); }
  ~BoundOfProcess() { CacheBudget::of_process()->set_bound(std::size_t{1000} << 20); }
};

TEST(CacheBudget, MeasuresTheSizesOfItems) {
  EXPECT_EQ(bytes_of(3.0), sizeof(double));
  EXPECT_EQ(bytes_of(Sized{77}), 77U);
  EXPECT_EQ(bytes_of(std::vector<float>(10)), 40U);
  EXPECT_EQ(bytes_of(std::vector<std::vector<char>>{std::vector<char>(5), std::vector<char>(7)}),
            2 * sizeof(std::vector<char>) + 12);
}

TEST(CacheBudget, DropsTheLeastRecentlyUsedOfAllCaches) {
  CacheBudget budget(100);
  const int a = 0, b = 0;
  budget.keep({&a, 0}, number(1), 40, 40);
  budget.keep({&b, 0}, number(2), 40, 40);
  EXPECT_NE(budget.find({&a, 0}), nullptr);
  budget.keep({&b, 1}, number(3), 20, 20);
  EXPECT_EQ(budget.used(), 100U);
  budget.keep({&a, 1}, number(4), 1, 1);
  EXPECT_EQ(budget.find({&b, 0}), nullptr);
  EXPECT_EQ(*std::static_pointer_cast<const int>(budget.find({&a, 0})), 1);
  EXPECT_EQ(budget.used(), 61U);
}

TEST(CacheBudget, DropsWhatExceedsTheBoundAtTheEndOfALoan) {
  const auto budget = std::make_shared<CacheBudget>(100);
  const int a = 0;
  {
    const CacheBudget::Loan loan(budget, 100), another(budget, 1000);
    EXPECT_EQ(budget->bound(), 200U);
    for (std::size_t i = 0; i < 6; ++i) budget->keep({&a, i}, number(0), 40, 10);
    EXPECT_EQ(budget->used(), 200U);
  }
  EXPECT_EQ(budget->bound(), 100U);
  EXPECT_EQ(budget->used(), 80U);
  EXPECT_NE(budget->find({&a, 5}), nullptr);
  const CacheBudget::Loan again(budget, 50);
  EXPECT_EQ(budget->bound(), 150U);
}

TEST(CacheBudget, DropsItemsWithTheLowestCostPerByteFirst) {
  CacheBudget budget(100);
  const int a = 0, b = 0;
  budget.keep({&a, 0}, number(1), 40, 80);
  for (std::size_t i = 0; i < 4; ++i) budget.keep({&b, i}, number(0), 40, 10);
  EXPECT_NE(budget.find({&a, 0}), nullptr);
  EXPECT_NE(budget.find({&b, 3}), nullptr);
  EXPECT_EQ(budget.find({&b, 2}), nullptr);
}

TEST(CacheBudget, DropsUnusedItemsEventually) {
  CacheBudget budget(100);
  const int a = 0, b = 0;
  budget.keep({&a, 0}, number(1), 40, 80);
  for (std::size_t i = 0; i < 20; ++i) budget.keep({&b, i}, number(0), 40, 10);
  EXPECT_EQ(budget.find({&a, 0}), nullptr);
}

TEST(CacheBudget, KeepsTheNewestItemOfAnySize) {
  CacheBudget budget(10);
  const int a = 0;
  budget.keep({&a, 0}, number(1), 5, 50);
  budget.keep({&a, 1}, number(2), 50, 1);
  EXPECT_EQ(budget.find({&a, 0}), nullptr);
  EXPECT_NE(budget.find({&a, 1}), nullptr);
}

TEST(CacheBudget, ForgetsTheItemsOfACache) {
  CacheBudget budget(100);
  const int a = 0, b = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    budget.keep({&a, i}, number(0), 10, 1);
    budget.keep({&b, i}, number(0), 10, 1);
  }
  budget.forget(&a, 3);
  EXPECT_EQ(budget.used(), 30U);
  EXPECT_EQ(budget.find({&a, 1}), nullptr);
  EXPECT_NE(budget.find({&b, 1}), nullptr);
}

TEST(CacheBudget, DropsItemsIfTheBoundDecreases) {
  CacheBudget budget(100);
  const int a = 0;
  for (std::size_t i = 0; i < 10; ++i) budget.keep({&a, i}, number(0), 10, 1);
  budget.set_bound(25);
  EXPECT_EQ(budget.used(), 20U);
  EXPECT_NE(budget.find({&a, 9}), nullptr);
}

// The sanitizers keep freed memory. GCC states them by macros, Clang as features.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DVI_FREED_MEMORY_IS_KEPT
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DVI_FREED_MEMORY_IS_KEPT
#endif
#endif

TEST(CacheBudget, ReturnsHolesOfTheHeapToTheSystemAboveALimit) {
#ifdef DVI_FREED_MEMORY_IS_KEPT
  GTEST_SKIP() << "a sanitizer keeps freed memory";
#endif
  const int a = 0;
  const std::size_t bytes = std::size_t{64} << 10, count = 3000;
  const auto measure_returned = [&](std::size_t limit) {
    CacheBudget budget(count * bytes);
    budget.set_trimmed_above(limit);
    std::vector<CacheBudget::Value> between;  // these prevent that the end of the heap is free
    for (std::size_t i = 0; i < count; ++i) {
      budget.keep({&a, i}, std::make_shared<const std::vector<char>>(bytes, 'x'), bytes, 1);
      between.push_back(number(0));
    }
    const std::size_t before = resident_memory();
    budget.set_bound(count / 3 * bytes);
    return static_cast<double>(before) - static_cast<double>(resident_memory());
  };
  EXPECT_GT(measure_returned(1), 0.5 * static_cast<double>(count * bytes));
  EXPECT_LT(measure_returned(std::size_t{1} << 40), 0.1 * static_cast<double>(count * bytes)) << "trimmed below the limit";
}

TEST(CacheBudget, IsSharedByAllSequencesOfTheProcess) {
  const std::size_t before = CacheBudget::of_process()->used();
  const BoundOfProcess bound(before + 100);
  int made = 0;
  {
    const auto make = [&](std::size_t) {
      ++made;
      return Sized{40};
    };
    const Lazy<Sized> one(5, make), other(5, make);
    one[0], other[0], one[0];
    EXPECT_EQ(made, 2);
    other[1];  // drops other[0]
    one[0];
    EXPECT_EQ(made, 3);
    other[0];
    EXPECT_EQ(made, 4);
  }
  EXPECT_LE(CacheBudget::of_process()->used(), before);
}

TEST(CacheBudget, DoesNotCacheItemsOfThroughTwice) {
  const std::size_t before = CacheBudget::of_process()->used();
  const Lazy<Sized> items(5, [](std::size_t i) { return Sized{i}; });
  const auto found = Lazy<Sized>::through(2, [items](std::size_t i) { return items[i + 3]; });
  EXPECT_EQ(found.size(), 2U);
  EXPECT_EQ(found[1], items[4]);
  EXPECT_EQ(CacheBudget::of_process()->used(), before + 4);
}

// Each item must be right and the sum of the sizes within the bound for any schedule of the threads.
TEST(CacheBudget, StaysWithinTheBoundWithManyThreads) {
  const auto budget = std::make_shared<CacheBudget>(1000);
  std::array<int, 4> caches{};
  std::atomic<int> wrong = 0;
  parallel_for(2000, [&](std::size_t n) {
    Random random(n);
    const std::size_t cache = random.below(4), i = 100 * n + random.below(100);
    budget->keep({&caches[cache], i}, number(static_cast<int>(i)), 1 + random.below(90), random.uniform());
    if (const auto value = budget->find({&caches[cache], i}))
      wrong += *std::static_pointer_cast<const int>(value) == static_cast<int>(i) ? 0 : 1;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(budget->used(), 1000U);
}

}  // namespace
}  // namespace dvi
