#include "dvi/objects/stationary_phases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/test_moving_cuboids.h"

namespace dvi::objects {
namespace {

MotionSegmentation segment_scans(const Drive& drive, const ScanPoses& poses) {
  const ground::ScanGround ground(drive, drive.poses);
  MovingReturns returns(drive, poses, ground);
  return segment_motion(returns, [] {});
}

MotionSegmentation segment_scans(const Situation& situation) {
  const Drive drive = situation.drive();
  return segment_scans(drive, {drive.poses});
}

bool contains(const Cuboid& cuboid, const Eigen::Vector2d& position) {
  return (position.array() > cuboid.min().head<2>().array() - 0.5).all() &&
         (position.array() < cuboid.max().head<2>().array() + 0.5).all();
}

// Returns the share of the first `scans` scans in which a track covers mover `k`.
double compute_covered_share(const Situation& situation, const std::vector<Track>& tracks, std::size_t k, int scans) {
  int covered = 0;
  for (int scan = 0; scan < scans; ++scan) {
    const Cuboid mover = situation.movers(scan)[k];
    covered += std::any_of(tracks.begin(), tracks.end(), [&](const Track& track) {
      return std::any_of(track.observations.begin(), track.observations.end(), [&](const Cluster& o) {
        return o.scan == static_cast<std::size_t>(scan) && contains(mover, o.center);
      });
    });
  }
  return covered / static_cast<double>(scans);
}

void expect_parked_car_remains(const std::vector<Track>& tracks) {
  for (const Track& track : tracks)
    for (const Cluster& o : track.observations) EXPECT_FALSE(contains(Situation::parked(), o.center)) << "scan " << o.scan;
}

// Returns the path length in meters of an object that accelerates from scan `start` on.
double compute_path_length(int scan, int start, double speed_mps) {
  const double t = std::max(0, scan - start) * 0.1, ramp_s = speed_mps / 3;
  return t < ramp_s ? 1.5 * t * t : speed_mps * (t - 0.5 * ramp_s);
}

TEST(StationaryPhases, FindsCarsInARowThatWaitForAnyTimeBeforeTheyLeave) {
  for (const int wait : {10, 50}) {
    const Situation situation{.scans = wait + 40, .movers = [&](int scan) {
                                return std::vector<Cuboid>{car_at(20 + compute_path_length(scan, wait, 8), 4),
                                                           car_at(29 + compute_path_length(scan, wait - 5, 8), 4)};
                              }};
    const MotionSegmentation found = segment_scans(situation);
    for (const std::size_t k : {0U, 1U})
      EXPECT_GT(compute_covered_share(situation, found.tracks, k, wait + 10), 0.95) << wait << ", car " << k;
    expect_parked_car_remains(found.tracks);
    EXPECT_TRUE(found.contradictory_scans.empty());
  }
}

TEST(StationaryPhases, FindsACarThatWaitsWhileTheSensorMovesTowardIt) {
  const Situation situation{
      .scans = 60,
      .sensor_x = [](int scan) { return 0.3 * scan; },
      .movers = [](int scan) { return std::vector<Cuboid>{car_at(45 + compute_path_length(scan, 35, 8), -1)}; }};
  const MotionSegmentation found = segment_scans(situation);
  EXPECT_GT(compute_covered_share(situation, found.tracks, 0, situation.scans), 0.95);
  expect_parked_car_remains(found.tracks);
}

TEST(StationaryPhases, FindsACarThatArrivesAndStopsUntilTheEnd) {
  const Situation situation{.scans = 80, .movers = [](int scan) {
                              return std::vector<Cuboid>{car_at(30 - compute_path_length(80 - scan, 50, 8), 1)};
                            }};
  const MotionSegmentation found = segment_scans(situation);
  EXPECT_GT(compute_covered_share(situation, found.tracks, 0, situation.scans), 0.95);
  expect_parked_car_remains(found.tracks);
}

TEST(StationaryPhases, FindsAPersonWhoWaitsBehindPassingTrafficAndThenCrosses) {
  const Situation situation{.scans = 90, .movers = [](int scan) {
                              return std::vector<Cuboid>{person_at(22, -4 + compute_path_length(scan, 50, 1.4)),
                                                         car_at(-30 + 1.2 * scan, -3)};
                            }};
  const MotionSegmentation found = segment_scans(situation);
  EXPECT_GT(compute_covered_share(situation, found.tracks, 0, situation.scans), 0.85)
      << "the car hides the person for some scans";
}

TEST(StationaryPhases, IgnoresObjectsThatAreStationaryForTheWholeDrive) {
  const Situation situation{.scans = 60,
                            .sensor_x = [](int scan) { return 0.6 * scan; },
                            .movers = [](int) { return std::vector<Cuboid>{car_at(25, 3), car_at(32, 3), person_at(20, -3)}; }};
  EXPECT_TRUE(segment_scans(situation).tracks.empty());
}

TEST(Contradictions, ExcludeScansWithWrongPoses) {
  const Situation situation{.scans = 24, .movers = [](int) { return std::vector<Cuboid>(); }, .yaw_error_deg = 6};
  const MotionSegmentation found = segment_scans(situation);
  EXPECT_TRUE(found.tracks.empty());
  EXPECT_GT(found.contradictory_scans.size(), 12U);
}

TEST(Contradictions, UntrustedScansAreNotUsed) {
  const Situation situation{.scans = 30, .movers = [](int scan) { return std::vector<Cuboid>{car_at(10 + 0.8 * scan, 1)}; }};
  const Drive drive = situation.drive();
  ScanPoses poses{drive.poses};
  EXPECT_FALSE(segment_scans(drive, poses).tracks.empty());
  poses.untrusted = std::vector<bool>(30, true);
  EXPECT_TRUE(segment_scans(drive, poses).tracks.empty());
}

}  // namespace
}  // namespace dvi::objects
