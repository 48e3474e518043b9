#include "dvi/core/run_plan.h"

#include <gtest/gtest.h>

namespace dvi {
namespace {

RunPlan plan() { return RunPlan({{"map", 10}, {"fill", 80}, {"video", 10}}); }

TEST(RunPlan, NumbersStagesAndSkipsCachedOnes) {
  RunPlan run = plan();
  EXPECT_EQ(run.number(), 0U);
  run.begin("fill");
  EXPECT_EQ(run.number(), 2U);
  run.end(1);
  run.begin("something else");
  EXPECT_EQ(run.number(), 2U) << "an unplanned stage is part of the previous one";
  run.begin("map");
  EXPECT_EQ(run.number(), 2U) << "the number never decreases";
  EXPECT_EQ(run.count(), 3U);
}

TEST(RunPlan, DoesNotPassAStageThatIsNeverSkipped) {
  RunPlan run({{"map", 1}, {"eval one", 1, true}, {"map", 1}, {"eval two", 1, true}});
  run.begin("map");
  run.begin("map");
  EXPECT_EQ(run.number(), 1U) << "the other stage is in the next part";
  run.begin("eval one");
  run.begin("map");
  EXPECT_EQ(run.number(), 3U);
}

TEST(RunPlan, EstimatesTheTimeLeftFromPreviousStages) {
  RunPlan run = plan();
  run.begin("map");
  EXPECT_FALSE(run.seconds_left(1, 1.0)) << "too little is done";
  EXPECT_DOUBLE_EQ(run.seconds_left(5, 5.0).value_or(0), 5 + 90) << "half of a tenth took 5 s";
  run.end(20);
  run.begin("fill");
  EXPECT_DOUBLE_EQ(run.seconds_left(0, std::nullopt).value_or(0), 180) << "two seconds for each unit of cost";
  EXPECT_DOUBLE_EQ(run.seconds_left(60, 20.0).value_or(0), 20 + 10 * 80.0 / 70)
      << "the rate of the stage is used once it is known";
  run.end(80);
  run.begin("video");
  EXPECT_NEAR(run.seconds_left(0, std::nullopt).value_or(0), 10 * 100.0 / 90, 1e-9);
}

TEST(RunPlan, HasNoNegativeTimeLeft) {
  RunPlan run = plan();
  run.begin("map");
  run.end(10);
  run.begin("fill");
  EXPECT_DOUBLE_EQ(run.seconds_left(500, std::nullopt).value_or(-1), 10);
}

TEST(RunPlan, EstimatesNothingWithoutCosts) {
  RunPlan run({{"a", 0}, {"b", 0}});
  run.begin("a");
  EXPECT_FALSE(run.seconds_left(0, std::nullopt));
}

}  // namespace
}  // namespace dvi
