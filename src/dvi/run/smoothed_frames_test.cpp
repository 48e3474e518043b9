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

/// A frame whose color and gain are the number of its view; after smoothing, its color has the numbers of its neighbors, too.
result::FilledView make_numbered(std::size_t view) {
  result::FilledView out;
  out.frame.color = cv::Mat3f(1, 1, cv::Vec3f(static_cast<float>(view), -1, -1));
  out.frame.mask = cv::Mat1b(1, 1, uchar{0});
  out.frame.gain = cv::Vec3f::all(static_cast<float>(view));
  return out;
}

struct Recorded {
  std::map<std::size_t, int> filled, paired;
  std::map<std::size_t, cv::Vec3f> written;  // view, before, after
};

/// Makes the views of a camera, one per second.
Views make_views(std::size_t count) {
  Views out;
  for (std::size_t i = 0; i < count; ++i)
    out.views.push_back(
        {.frame = i, .time_ns = static_cast<std::int64_t>(i) * 1000000000, .camera = {}, .camera_from_world = {}});
  return out;
}

Recorded run(const std::vector<std::size_t>& views, const Views& all, bool smooth) {
  Recorded out;
  std::mutex mutex;
  FrameSteps steps;
  steps.fill = [&](std::size_t view) {
    const std::lock_guard lock(mutex);
    ++out.filled[view];
    return make_numbered(view);
  };
  if (smooth)
    steps.smoothing =
        Smoothing{.pair =
                      [&](const harmonize::FilledFrame& earlier, const harmonize::FilledFrame& later) {
                        const std::lock_guard lock(mutex);
                        ++out.paired[static_cast<std::size_t>(earlier.gain[0])];
                        return smooth::FramePair(earlier, later);
                      },
                  .smooth =
                      [](const smooth::FramePair* before, const harmonize::FilledFrame& frame, const smooth::FramePair* after) {
                        harmonize::FilledFrame smoothed = frame;
                        smoothed.color = frame.color.clone();
                        smoothed.color(0, 0)[1] = before == nullptr ? -1 : before->earlier_gain[0];
                        smoothed.color(0, 0)[2] = after == nullptr ? -1 : after->later_gain[0];
                        return smoothed;
                      }};
  steps.write = [&](std::size_t view, const result::FilledView& finished) {
    const std::lock_guard lock(mutex);
    out.written[view] = finished.frame.color(0, 0);
  };
  for_each_smoothed(views, all, steps);
  return out;
}

TEST(SmoothedFrames, EachFrameIsSmoothedBetweenItsNeighbors) {
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    const Recorded all = run({0, 1, 2, 3, 4}, make_views(5), true);
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
  const Recorded some = run({3}, make_views(6), true);
  EXPECT_THAT(some.filled, ElementsAre(Pair(2, 1), Pair(3, 1), Pair(4, 1)));
  EXPECT_THAT(some.written, ElementsAre(Pair(3, cv::Vec3f(3, 2, 4))));
}

TEST(SmoothedFrames, WithoutSmoothingNoNeighborsAreFilled) {
  const Recorded some = run({1, 4}, make_views(6), false);
  EXPECT_THAT(some.filled, ElementsAre(Pair(1, 1), Pair(4, 1)));
  EXPECT_THAT(some.written, ElementsAre(Pair(1, cv::Vec3f(1, -1, -1)), Pair(4, cv::Vec3f(4, -1, -1))));
}

TEST(SmoothedFrames, CamerasAreFilledInTurnAndSmoothedApart) {
  Views all = make_views(3);
  all.cleaned_sequences = 2;
  for (std::size_t i = 0; i < 3; ++i)
    all.views.push_back({.sequence = 1,
                         .frame = i,
                         .time_ns = static_cast<std::int64_t>(i) * 1000000000 + 1,
                         .camera = {},
                         .camera_from_world = {}});
  const ThreadLimit limit(1);
  std::vector<std::size_t> order;
  FrameSteps steps;
  steps.fill = [&](std::size_t view) {
    order.push_back(view);
    return make_numbered(view);
  };
  steps.write = [](std::size_t, const result::FilledView&) {};
  for_each_smoothed({0, 1, 2, 3, 4, 5}, all, steps);
  EXPECT_THAT(order, ElementsAre(0, 3, 1, 4, 2, 5));
  const Recorded smoothed = run({0, 1, 2, 3, 4, 5}, all, true);
  EXPECT_THAT(smoothed.written,
              ElementsAre(Pair(0, cv::Vec3f(0, -1, 1)), Pair(1, cv::Vec3f(1, 0, 2)), Pair(2, cv::Vec3f(2, 1, -1)),
                          Pair(3, cv::Vec3f(3, -1, 4)), Pair(4, cv::Vec3f(4, 3, 5)), Pair(5, cv::Vec3f(5, 4, -1))));
}

TEST(SmoothedFrames, WithoutViewsNothingIsFilled) { EXPECT_TRUE(run({}, make_views(6), true).filled.empty()); }

}  // namespace
}  // namespace dvi::run
