#include "dvi/run/smoothed_frames.h"

#include <map>
#include <mutex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dvi/core/threads.h"

namespace dvi::run {
namespace {

using testing::ElementsAre;
using testing::Pair;

/// A frame whose color is the number of its view, and after smoothing also the numbers of its neighbors.
result::FilledView make_numbered(std::size_t view) {
  result::FilledView out;
  out.frame.color = cv::Mat3f(1, 1, cv::Vec3f(static_cast<float>(view), -1, -1));
  out.frame.mask = cv::Mat1b(1, 1, uchar{0});
  return out;
}

float number_of(const harmonize::FilledFrame* frame) { return frame == nullptr ? -1.0F : frame->color(0, 0)[0]; }

struct Recorded {
  std::map<std::size_t, int> filled, paired;
  std::map<std::size_t, cv::Vec3f> written;  // view, before, after
};

Recorded run(const std::vector<std::size_t>& views, std::size_t count, bool smooth) {
  Recorded out;
  std::mutex mutex;
  FrameSteps steps;
  steps.fill = [&](std::size_t view) {
    const std::lock_guard lock(mutex);
    ++out.filled[view];
    return make_numbered(view);
  };
  if (smooth)
    steps.smoothing = Smoothing{
        .pair =
            [&](const harmonize::FilledFrame& earlier, const harmonize::FilledFrame& later) {
              const std::lock_guard lock(mutex);
              ++out.paired[static_cast<std::size_t>(number_of(&earlier))];
              return smooth::FramePair(earlier, later);
            },
        .smooth =
            [](const smooth::FramePair* before, const harmonize::FilledFrame& frame, const smooth::FramePair* after) {
              harmonize::FilledFrame smoothed = frame;
              smoothed.color = cv::Mat3f(1, 1,
                                         cv::Vec3f(number_of(&frame), number_of(before == nullptr ? nullptr : &before->earlier),
                                                   number_of(after == nullptr ? nullptr : &after->later)));
              return smoothed;
            }};
  steps.write = [&](std::size_t view, const result::FilledView& finished) {
    const std::lock_guard lock(mutex);
    out.written[view] = finished.frame.color(0, 0);
  };
  for_each_smoothed(views, count, steps);
  return out;
}

TEST(SmoothedFrames, EachFrameIsSmoothedBetweenItsNeighbors) {
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    const Recorded all = run({0, 1, 2, 3, 4}, 5, true);
    ASSERT_EQ(all.written.size(), 5U);
    for (std::size_t i = 0; i < 5; ++i) {
      const auto at = static_cast<float>(i);
      EXPECT_EQ(all.written.at(i), cv::Vec3f(at, at - 1, i == 4 ? -1 : at + 1)) << i;
      EXPECT_EQ(all.filled.at(i), 1) << i;
    }
    EXPECT_THAT(all.paired, ElementsAre(Pair(0, 1), Pair(1, 1), Pair(2, 1), Pair(3, 1)));
  }
}

TEST(SmoothedFrames, NeighborsOfMissingFramesAreFilledButNotWritten) {
  const Recorded some = run({3}, 6, true);
  EXPECT_THAT(some.filled, ElementsAre(Pair(2, 1), Pair(3, 1), Pair(4, 1)));
  EXPECT_THAT(some.written, ElementsAre(Pair(3, cv::Vec3f(3, 2, 4))));
}

TEST(SmoothedFrames, WithoutSmoothingNoNeighborsAreFilled) {
  const Recorded some = run({1, 4}, 6, false);
  EXPECT_THAT(some.filled, ElementsAre(Pair(1, 1), Pair(4, 1)));
  EXPECT_THAT(some.written, ElementsAre(Pair(1, cv::Vec3f(1, -1, -1)), Pair(4, cv::Vec3f(4, -1, -1))));
}

TEST(SmoothedFrames, WithoutViewsNothingIsFilled) { EXPECT_TRUE(run({}, 6, true).filled.empty()); }

}  // namespace
}  // namespace dvi::run
