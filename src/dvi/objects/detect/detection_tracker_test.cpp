#include "dvi/objects/detect/detection_tracker.h"

#include <map>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace dvi::objects {
namespace {

constexpr std::int64_t kFramePeriodNs = 100'000'000;

Detection rectangle(cv::Rect box, int type = 0) { return {type, 0.8F, box, cv::Mat1b(box.size(), uchar{255})}; }

// Tracks the detections of all frames. Returns the objects per frame.
std::map<std::size_t, std::vector<TrackedObject>> track(const std::vector<Detections>& frames,
                                                        std::int64_t step = kFramePeriodNs) {
  DetectionTracker tracker;
  std::map<std::size_t, std::vector<TrackedObject>> out;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    tracker.add(static_cast<std::int64_t>(i) * step, frames[i]);
    if (i % 3 == 2)  // at any time
      for (TrackedObject& object : tracker.take()) out[object.frame].push_back(object);
  }
  for (TrackedObject& object : tracker.take()) out[object.frame].push_back(object);
  return out;
}

TEST(DetectionTracker, InterpolatesMissingDetectionsOfAMovingObject) {
  const auto at = [](int i) { return cv::Rect(10 + 12 * i, 20 - i, 30, 20); };
  for (const std::vector<int>& missing : {std::vector<int>{3}, {3, 4}, {2, 5}, {2, 4, 6}}) {
    std::vector<Detections> frames;
    for (int i = 0; i < 8; ++i) {
      const bool gone = std::find(missing.begin(), missing.end(), i) != missing.end();
      frames.push_back(gone ? Detections() : Detections{rectangle(at(i))});
    }
    const auto found = track(frames);
    for (int i = 0; i < 8; ++i) {
      ASSERT_TRUE(found.contains(static_cast<std::size_t>(i))) << i;
      const std::vector<TrackedObject>& objects = found.at(static_cast<std::size_t>(i));
      ASSERT_EQ(objects.size(), 1U);
      EXPECT_EQ(objects[0].track, 0);
      EXPECT_EQ(objects[0].object.box, at(i)) << i;
      EXPECT_EQ(cv::countNonZero(objects[0].object.mask), at(i).area());
      EXPECT_EQ(objects[0].is_interpolated, frames[static_cast<std::size_t>(i)].empty());
    }
  }
}

TEST(DetectionTracker, DoesNotInterpolateLongGaps) {
  const auto with_gap = [](std::size_t missing) {
    std::vector<Detections> frames(missing + 2);
    frames.front() = frames.back() = {rectangle({10, 10, 20, 20})};
    return frames;
  };
  EXPECT_EQ(track(with_gap(4)).size(), 6U) << "half a second";
  const auto found = track(with_gap(5));
  EXPECT_EQ(found.size(), 2U);
  EXPECT_EQ(found.at(6)[0].track, 1) << "it may be another object";
  EXPECT_EQ(track(with_gap(1), 10 * kFramePeriodNs).size(), 2U);
}

TEST(DetectionTracker, SeparatesObjectsAndClasses) {
  const cv::Rect left{10, 10, 20, 20}, right{40, 10, 20, 20};
  std::vector<Detections> frames{{rectangle(left), rectangle(right)}, {}, {rectangle(right), rectangle(left)}};
  auto found = track(frames);
  ASSERT_EQ(found.at(1).size(), 2U);
  for (const TrackedObject& object : found.at(1)) EXPECT_EQ(object.object.box, object.track == 0 ? left : right);
  frames = {{rectangle(left, 0)}, {}, {rectangle(left, 1)}};
  found = track(frames);
  EXPECT_FALSE(found.contains(1));
  EXPECT_EQ(found.at(2)[0].track, 1);
}

TEST(DetectionTracker, ContinuesEachTrackOnce) {
  const cv::Rect box{10, 10, 20, 20};
  const auto found = track({{rectangle(box)}, {rectangle(box), rectangle({12, 10, 20, 20})}});
  ASSERT_EQ(found.at(1).size(), 2U);
  EXPECT_EQ(found.at(1)[0].track, 0);
  EXPECT_EQ(found.at(1)[1].track, 1);
}

TEST(Interpolation, ScalesTheBoxAndUnitesBothOutlines) {
  const Detection grown = interpolate(rectangle({0, 0, 10, 10}), rectangle({20, 10, 30, 20}), 0.5);
  EXPECT_EQ(grown.box, cv::Rect(10, 5, 20, 15));
  EXPECT_EQ(cv::countNonZero(grown.mask), 300);
  Detection left = rectangle({0, 0, 10, 10}), right = rectangle({5, 0, 10, 10});
  left.mask.colRange(5, 10) = 0;
  right.mask.rowRange(5, 10) = 0;
  const Detection both = interpolate(left, right, 0.5);
  EXPECT_EQ(both.box, cv::Rect(2, 0, 11, 10)) << "extended to whole pixels";
  EXPECT_EQ(cv::countNonZero(both.mask(cv::Rect(6, 5, 5, 5))), 0) << "neither has it";
}

TEST(Overlap, IsThatOfTheShiftedOutlines) {
  EXPECT_EQ(compute_overlap(rectangle({0, 0, 10, 10}), {0, 0}, rectangle({20, 0, 10, 10})), 0);
  EXPECT_EQ(compute_overlap(rectangle({0, 0, 10, 10}), {20, 0}, rectangle({20, 0, 10, 10})), 1);
  EXPECT_NEAR(compute_overlap(rectangle({0, 0, 10, 10}), {15, 0}, rectangle({20, 0, 10, 10})), 1 / 3.0, 1e-12);
}

}  // namespace
}  // namespace dvi::objects
