#include "dvi/datasets/box_track.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dvi::datasets {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kKeyFrameNs = 500'000'000;  // nuScenes annotates twice a second

// An object that drives 5 m/s along x, with boxes at the given key frames, shifted sideways by `aside` meters from key frame 4
// on.
BoxTrack track_with(const std::vector<int>& keys, double aside = 0) {
  BoxTrack track{.number = 3, .type = "car", .boxes = {}};
  for (const int key : keys)
    track.boxes[key * kKeyFrameNs] = {{Eigen::Matrix3d::Identity(), {2.5 * key, key < 4 ? 0 : aside, 0}}, {4, 2, 1.5}};
  return track;
}

Drive recording_of(int frames) {
  Drive drive;
  for (int i = 0; i < frames; ++i) drive.frames.push_back({i, std::to_string(i), std::int64_t{i} * 100'000'000, {}, {}});
  return drive;
}

TEST(BoxTrack, InterpolatesBetweenKeyFramesAndExtrapolatesSlightly) {
  const BoxTrack track = track_with({0, 1, 3});
  EXPECT_NEAR(track.at(kKeyFrameNs / 2)->frame_from_box.t.x(), 1.25, 1e-9);
  EXPECT_NEAR(track.at(2 * kKeyFrameNs)->frame_from_box.t.x(), 5, 1e-9) << "one key frame is missing";
  EXPECT_NEAR(track.at(3 * kKeyFrameNs + 200'000'000)->frame_from_box.t.x(), 8.5, 1e-9);
  EXPECT_FALSE(track.at(4 * kKeyFrameNs));
  EXPECT_FALSE(describe_gaps({track}, recording_of(20)));
}

TEST(BoxTrack, BridgesGapsOfSteadyMotion) {
  const BoxTrack track = track_with({0, 1, 6, 7});
  ASSERT_EQ(track.gaps().size(), 1U);
  EXPECT_TRUE(track.gaps()[0].bridged);
  EXPECT_NEAR(track.at(3 * kKeyFrameNs)->frame_from_box.t.x(), 7.5, 1e-9);
  EXPECT_THAT(*describe_gaps({track}, recording_of(40)),
              AllOf(HasSubstr("1 labeled objects"), HasSubstr("1 gaps are interpolated"), Not(HasSubstr("are not"))));
}

TEST(BoxTrack, ReportsGapsWithUnknownMotion) {
  const BoxTrack turned = track_with({0, 1, 6, 7}, 20), long_gap = track_with({0, 1, 15, 16}), lone = track_with({0, 6});
  for (const BoxTrack& track : {turned, long_gap, lone}) {
    ASSERT_EQ(track.gaps().size(), 1U);
    EXPECT_FALSE(track.gaps()[0].bridged);
    EXPECT_FALSE(track.at(3 * kKeyFrameNs));
    EXPECT_TRUE(track.at(track.boxes.begin()->first + 200'000'000)) << "near a key frame it is known";
  }
  EXPECT_THAT(*describe_gaps({turned}, recording_of(40)),
              AllOf(HasSubstr("0 gaps are interpolated, 1 are not"), HasSubstr("the objects are not removed in frames 8-27"),
                    HasSubstr("the first is a car in frames 8-27")));
  EXPECT_FALSE(describe_gaps({turned}, recording_of(5))) << "the gap lies after the end of the drive";
}

TEST(BoxTrack, BridgesGapsOfStationaryObjects) {
  BoxTrack parked{.number = 0, .type = "car", .boxes = {}};
  for (const int key : {0, 8})
    parked.boxes[key * kKeyFrameNs] = {{Eigen::Matrix3d::Identity(), {0.05 * key, 3, 0}}, {4, 2, 1.5}};
  EXPECT_TRUE(parked.gaps().at(0).bridged);
  EXPECT_NEAR(parked.at(4 * kKeyFrameNs)->frame_from_box.t.x(), 0.2, 1e-9);
}

}  // namespace
}  // namespace dvi::datasets
