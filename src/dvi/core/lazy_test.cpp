#include "dvi/core/lazy.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "dvi/core/random.h"
#include "dvi/core/threads.h"

namespace dvi {
namespace {

TEST(Lazy, HasNoItemsIfEmpty) {
  EXPECT_TRUE(Lazy<int>().empty());
  EXPECT_EQ(Lazy<int>(3, 1, [](std::size_t) { return 0; }).size(), 3U);
}

TEST(Lazy, MakesACachedItemOnce) {
  int made = 0;
  const Lazy<int> lazy(10, 2, [&](std::size_t i) {
    ++made;
    return static_cast<int>(i) * 2;
  });
  EXPECT_EQ(made, 0);
  EXPECT_EQ(*lazy[3], 6);
  EXPECT_EQ(*lazy[3], 6);
  EXPECT_EQ(made, 1);
  const Lazy<int> copy = lazy;  // NOLINT(performance-unnecessary-copy-initialization): copies share the cache
  EXPECT_EQ(*copy[3], 6);
  EXPECT_EQ(made, 1);
}

TEST(Lazy, DropsTheLeastRecentlyUsed) {
  std::vector<std::size_t> made;
  const Lazy<int> lazy(10, 2, [&](std::size_t i) {
    made.push_back(i);
    return 0;
  });
  for (const std::size_t i : {0, 1, 0, 2, 0, 1}) lazy[i];
  EXPECT_EQ(made, (std::vector<std::size_t>{0, 1, 2, 1}));
}

TEST(Lazy, KeepsHeldItemsAlive) {
  std::shared_ptr<const std::vector<int>> held;
  {
    const Lazy<std::vector<int>> lazy(3, 1, [](std::size_t i) { return std::vector<int>(100, static_cast<int>(i)); });
    held = lazy[0];
    lazy[1];
  }
  EXPECT_EQ(held->at(99), 0);
}

struct Counted {
  explicit Counted(std::atomic<int>& alive) : alive_(alive) { ++alive_; }
  Counted(Counted&& other) noexcept : alive_(other.alive_) { ++alive_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  ~Counted() { --alive_; }

 private:
  std::atomic<int>& alive_;
};

TEST(Lazy, KeepsNoMoreThanItsCapacity) {
  std::atomic<int> alive = 0;
  const Lazy<Counted> lazy(100, 5, [&](std::size_t) { return Counted(alive); });
  for (std::size_t i = 0; i < 100; ++i) {
    lazy[i];
    EXPECT_LE(alive, 5);
  }
  EXPECT_EQ(alive, 5);
}

TEST(Lazy, RethrowsAndTriesAgain) {
  int tries = 0;
  const Lazy<int> lazy(1, 1, [&](std::size_t) {
    if (++tries == 1) throw std::runtime_error("once");
    return 7;
  });
  EXPECT_THROW(lazy[0], std::runtime_error);
  EXPECT_EQ(*lazy[0], 7);
}

TEST(Lazy, MakesAnItemOnceWithManyThreads) {
  std::vector<std::atomic<int>> made(8);
  const Lazy<int> lazy(8, 8, [&](std::size_t i) {
    ++made[i];
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return static_cast<int>(i);
  });
  std::vector<std::thread> threads;
  threads.reserve(4);
  std::atomic<bool> right = true;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (std::size_t i = 0; i < 8; ++i)
        if (*lazy[i] != static_cast<int>(i)) right = false;
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(right);
  for (const auto& count : made) EXPECT_EQ(count, 1);
}

// The first caller is making item 2 when the second one comes to it, which makes the others meanwhile.
TEST(Lazy, LeavesItemsThatOthersAreMakingForLast) {
  std::vector<std::atomic<int>> made(5);
  std::atomic<bool> is_begun = false;
  std::atomic<int> others = 0;
  const Lazy<int> lazy(5, 5, [&](std::size_t i) {
    ++made[i];
    if (i == 2) {
      is_begun = true;
      while (others < 4) std::this_thread::yield();
    } else {
      ++others;
    }
    return static_cast<int>(i) * 10;
  });
  std::thread first([&] { lazy[2]; });
  while (!is_begun) std::this_thread::yield();
  EXPECT_EQ(lazy.get_unless_in_work(2), nullptr);
  const std::vector<std::size_t> numbers{2, 0, 1, 4, 3};
  std::vector<int> values(5);
  for_each_item(lazy, numbers, [&](std::size_t k, const std::shared_ptr<const int>& item) { values[k] = *item; });
  first.join();
  EXPECT_EQ(values, (std::vector<int>{20, 0, 10, 40, 30}));
  for (const auto& count : made) EXPECT_EQ(count, 1);
}

// Items run parallel loops while other tasks wait for the same items. This must neither deadlock nor mix items.
TEST(Lazy, SupportsParallelLoopsInItemsOfAParallelLoop) {
  const Lazy<std::vector<int>> lazy(16, 3, [](std::size_t i) {
    std::vector<int> out(64);
    parallel_for(out.size(), [&](std::size_t k) { out[k] = static_cast<int>(i * k); });
    return out;
  });
  std::vector<int> results(400);
  parallel_for(results.size(), [&](std::size_t n) {
    Random random(n);
    const std::size_t i = random.below(16), k = random.below(64);
    results[n] = (*lazy[i])[k] - static_cast<int>(i * k);
  });
  EXPECT_EQ(results, std::vector<int>(400, 0));
}

}  // namespace
}  // namespace dvi
