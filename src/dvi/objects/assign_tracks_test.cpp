#include "dvi/objects/assign_tracks.h"

#include <gmock/gmock.h>

namespace dvi::objects {
namespace {

TEST(AssignTracks, AssignsTheLowestCostFirstAndEachTrackOnce) {
  const std::vector<TrackCandidate> candidates{{3, 0, 0}, {1, 0, 1}, {2, 1, 1}, {4, 1, 0}};
  EXPECT_THAT(assign_tracks(candidates, 3), testing::ElementsAre(1, 0, std::nullopt));
}

TEST(AssignTracks, PrefersEarlierTracksAmongEqualCosts) {
  EXPECT_THAT(assign_tracks({{1, 1, 0}, {1, 0, 0}}, 1), testing::ElementsAre(0));
}

}  // namespace
}  // namespace dvi::objects
