#include "dvi/objects/merge_tracks.h"

#include <gtest/gtest.h>

#include <cmath>

namespace dvi::objects {
namespace {

// The returns on the side of a car in scans [first, last), from [from, to) meters along the car.
struct SideOfCar {
  std::size_t first, last;
  double from, to;
  double speed_mps = 8;
};

Track make_track(const SideOfCar& side) {
  const auto [first, last, from, to, speed_mps] = side;
  Track track;
  for (std::size_t scan = first; scan < last; ++scan) {
    Cluster cluster;
    cluster.scan = scan;
    for (double x = 0; x < 4; x += 0.125) {
      if (x < from || x >= to) continue;
      const auto at = static_cast<double>(scan);
      cluster.returns.push_back({{x + 0.1 * speed_mps * at, 1, 0.5}, std::llround(1e8 * at), 0, 0.1});
    }
    measure(cluster);
    track.observations.push_back(cluster);
  }
  track.height_m = to - from;
  track.size_m = {to - from, 1};
  return track;
}

TEST(MergeTracks, MergesTracksOfOneCarThatWasLostAndFoundAgain) {
  const std::vector<Track> tracks = merge_duplicates({make_track({0, 12, 0, 2.5}), make_track({6, 20, 1, 4})});
  ASSERT_EQ(tracks.size(), 1U);
  const std::vector<Cluster>& observations = tracks.front().observations;
  ASSERT_EQ(observations.size(), 20U);
  for (std::size_t scan = 0; scan < 20; ++scan) EXPECT_EQ(observations[scan].scan, scan);
  EXPECT_EQ(observations[3].returns.size(), 20U);
  EXPECT_EQ(observations[8].returns.size(), 32U) << "each return once";
  EXPECT_NEAR(observations[8].extent_m, 3.875, 1e-4);
  EXPECT_EQ(tracks.front().size_m.x(), 3);
}

TEST(MergeTracks, SeparatesTracksWithFewCommonReturnsOrScans) {
  EXPECT_EQ(merge_duplicates({make_track({0, 20, 0, 2.5}), make_track({0, 20, 2, 4})}).size(), 2U) << "bumper to bumper";
  EXPECT_EQ(merge_duplicates({make_track({0, 20, 0, 4}), make_track({0, 20, 0, 4, 7.9})}).size(), 2U) << "same place at first";
  EXPECT_EQ(merge_duplicates({make_track({0, 10, 0, 4}), make_track({8, 20, 0, 4})}).size(), 2U) << "two scans are too few";
  EXPECT_EQ(merge_duplicates({make_track({0, 5, 0, 4}), make_track({9, 20, 0, 4}), Track{}}).size(), 3U);
}

}  // namespace
}  // namespace dvi::objects
