#include "dvi/inputs/memory_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/cache_budget.h"
#include "dvi/core/scratch.h"
#include "dvi/core/work_memory.h"

namespace dvi::inputs {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const cv::Size kSmall(320, 180), kLarge(3840, 2160);

TEST(MemoryPlan, IsAThirdEachIfFramesAreSmall) {
  const MemoryPlan plan = plan_memory(750, kSmall);
  EXPECT_EQ(plan.map_bytes, 200'000'000U);
  EXPECT_EQ(plan.cache_bytes, 200'000'000U);
  EXPECT_EQ(plan.work_bytes, 200'000'000U);
}

TEST(MemoryPlan, HasWorkForOneLargeFrame) {
  for (const int memory_mb : {1600, 1800, 2000, 4000}) {
    const MemoryPlan plan = plan_memory(memory_mb, kLarge);
    EXPECT_LE(plan.needed_mb, memory_mb);
    EXPECT_GE(plan.work_bytes, estimate_frame_bytes(kLarge));
    EXPECT_LE(plan.map_bytes + plan.cache_bytes + plan.work_bytes, static_cast<std::size_t>(memory_mb - 150) * 1'000'000);
  }
}

TEST(MemoryPlan, NeverExceedsTheMemory) {
  for (const int memory_mb : {16, 150, 500, 1000}) {
    const MemoryPlan plan = plan_memory(memory_mb, kLarge);
    EXPECT_GT(plan.needed_mb, memory_mb);
    EXPECT_LE(plan.map_bytes + plan.cache_bytes + plan.work_bytes, static_cast<std::size_t>(memory_mb) * 1'000'000);
  }
}

TEST(MemoryPlan, SetsTheBoundsOfTheProcessAndWarnsIfOneFrameDoesNotFit) {
  EXPECT_EQ(bound_memory(750, kSmall), std::nullopt);
  EXPECT_EQ(Scratch::of_process()->bound(), 200'000'000U);
  EXPECT_EQ(WorkMemory::of_process()->bound(), 200'000'000U);
  use_free_map_memory_for_work();
  EXPECT_EQ(WorkMemory::of_process()->bound(), 400'000'000U);
  const auto warning = bound_memory(500, kLarge);
  ASSERT_TRUE(warning);
  const std::string needed = std::to_string(plan_memory(500, kLarge).needed_mb);
  EXPECT_THAT(*warning,
              AllOf(HasSubstr("3840x2160"), HasSubstr("need " + needed + " MB"), HasSubstr("--set job.memory_mb=" + needed)));
  EXPECT_EQ(bound_memory(std::stoi(needed), kLarge), std::nullopt);
}

}  // namespace
}  // namespace dvi::inputs
