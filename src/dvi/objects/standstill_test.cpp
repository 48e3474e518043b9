#include "dvi/objects/standstill.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "dvi/core/random.h"
#include "dvi/objects/find_traffic.h"
#include "dvi/objects/plain.h"

namespace dvi::objects {
namespace {

using Cuboid = Eigen::AlignedBox3d;  // world axes; the ground is z = 0

Cuboid car_at(double x, double y) { return {Eigen::Vector3d(x, y, 0.2), Eigen::Vector3d(x + 4, y + 1.8, 1.5)}; }
Cuboid person_at(double x, double y) { return {Eigen::Vector3d(x, y, 0), Eigen::Vector3d(x + 0.5, y + 0.6, 1.8)}; }

// A street between houses, with a parked car, scanned by a LiDAR that drives along x. Entries of `movers` may move.
struct Situation {
  int scans = 0;
  std::function<double(int)> sensor_x = [](int) { return 0.0; };
  std::function<std::vector<Cuboid>(int)> movers;
  double degrees_between_beams = 0.4;
  double yaw_error_deg = 0;  // of each pose

  static std::vector<Cuboid> houses() {
    std::vector<Cuboid> out{{Eigen::Vector3d(70, -40, 0), Eigen::Vector3d(72, 40, 9)}};
    for (int i = -2; i < 7; ++i)
      for (const double y : {-14.0, 8.0})
        out.emplace_back(Eigen::Vector3d(10 * i, y, 0), Eigen::Vector3d(10 * i + 7, y + 6, 9));
    return out;
  }
  static Cuboid parked() { return car_at(14, -5.5); }

  SE3 pose(int scan) const { return {Eigen::Matrix3d::Identity(), {sensor_x(scan), 0, 1.7}}; }

  Scan measure(std::size_t i) const {
    constexpr double kDegree = std::numbers::pi / 180;
    std::vector<Cuboid> things = houses();
    things.push_back(parked());
    for (const Cuboid& mover : movers(static_cast<int>(i))) things.push_back(mover);
    const Eigen::Vector3d sensor = pose(static_cast<int>(i)).t;
    Random random(i + 1);
    Scan scan;
    for (double up = -20; up <= 3; up += degrees_between_beams)
      for (double aside = -180; aside < 180; aside += 0.5) {
        const Eigen::Vector3d ray(std::cos(aside * kDegree) * std::cos(up * kDegree),
                                  std::sin(aside * kDegree) * std::cos(up * kDegree), std::sin(up * kDegree));
        double length = ray.z() < 0 ? -sensor.z() / ray.z() : 1e9;
        for (const Cuboid& thing : things) length = std::min(length, range_to(thing, sensor, ray));
        if (length > 90) continue;
        scan.points.emplace_back(((length + 0.02 * random.normal()) * ray).cast<float>());
        scan.time.push_back(0);
        scan.intensity.push_back(0.5F);
      }
    return scan;
  }

  Drive drive() const {
    Drive out = Plain(scans, 0).drive;
    std::vector<StampedPose> poses;
    Random random(7);
    for (int i = 0; i < scans; ++i) {
      SE3 at = pose(i);
      at.R = Eigen::AngleAxisd(yaw_error_deg * random.normal() * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()).matrix();
      poses.push_back({i * Plain::kTenthOfSecond, at});
    }
    out.poses = Trajectory(poses);
    out.scans = Lazy<Scan>(static_cast<std::size_t>(scans), static_cast<std::size_t>(scans),
                           [self = *this](std::size_t i) { return self.measure(i); });
    return out;
  }

 private:
  static double range_to(const Cuboid& thing, const Eigen::Vector3d& sensor, const Eigen::Vector3d& ray) {
    const Eigen::Array3d a = (thing.min() - sensor).array() / ray.array(), b = (thing.max() - sensor).array() / ray.array();
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    return enter > 0 && enter < leave ? enter : 1e9;
  }
};

FoundTraffic traffic_of(const Situation& situation) {
  const Drive drive = situation.drive();
  return find_traffic(drive, {drive.poses}, ground::ScanGround(drive, drive.poses), [] {});
}

bool holds(const Cuboid& thing, const Eigen::Vector2d& place) {
  return (place.array() > thing.min().head<2>().array() - 0.5).all() &&
         (place.array() < thing.max().head<2>().array() + 0.5).all();
}

// The share of the first `scans` scans in which a track covers mover `k`.
double share_covered(const Situation& situation, const std::vector<Track>& tracks, std::size_t k, int scans) {
  int covered = 0;
  for (int scan = 0; scan < scans; ++scan) {
    const Cuboid mover = situation.movers(scan)[k];
    covered += std::any_of(tracks.begin(), tracks.end(), [&](const Track& track) {
      return std::any_of(track.observations.begin(), track.observations.end(),
                         [&](const Cluster& o) { return o.scan == static_cast<std::size_t>(scan) && holds(mover, o.center); });
    });
  }
  return covered / static_cast<double>(scans);
}

void expect_parked_stays(const std::vector<Track>& tracks) {
  for (const Track& track : tracks)
    for (const Cluster& o : track.observations) EXPECT_FALSE(holds(Situation::parked(), o.center)) << "scan " << o.scan;
}

// Meters from where it starts, for something that accelerates in scan `start`.
double path_length(int scan, int start, double speed_mps) {
  const double t = std::max(0, scan - start) * 0.1, ramp_s = speed_mps / 3;
  return t < ramp_s ? 1.5 * t * t : speed_mps * (t - 0.5 * ramp_s);
}

TEST(Standstill, FindsCarsInARowThatWaitHoweverLongBeforeTheyLeave) {
  for (const int wait : {10, 50}) {
    const Situation situation{.scans = wait + 40, .movers = [&](int scan) {
                                return std::vector<Cuboid>{car_at(20 + path_length(scan, wait, 8), 4),
                                                           car_at(29 + path_length(scan, wait - 5, 8), 4)};
                              }};
    const FoundTraffic found = traffic_of(situation);
    for (const std::size_t k : {0U, 1U})
      EXPECT_GT(share_covered(situation, found.tracks, k, wait + 10), 0.95) << wait << ", car " << k;
    expect_parked_stays(found.tracks);
    EXPECT_TRUE(found.contradictory.empty());
  }
}

TEST(Standstill, FindsACarThatWaitsWhileTheSensorMovesTowardIt) {
  const Situation situation{.scans = 60,
                            .sensor_x = [](int scan) { return 0.3 * scan; },
                            .movers = [](int scan) { return std::vector<Cuboid>{car_at(45 + path_length(scan, 35, 8), -1)}; }};
  const FoundTraffic found = traffic_of(situation);
  EXPECT_GT(share_covered(situation, found.tracks, 0, situation.scans), 0.95);
  expect_parked_stays(found.tracks);
}

TEST(Standstill, FindsACarThatArrivesAndStopsUntilTheEnd) {
  const Situation situation{
      .scans = 80, .movers = [](int scan) { return std::vector<Cuboid>{car_at(30 - path_length(80 - scan, 50, 8), 1)}; }};
  const FoundTraffic found = traffic_of(situation);
  EXPECT_GT(share_covered(situation, found.tracks, 0, situation.scans), 0.95);
  expect_parked_stays(found.tracks);
}

TEST(Standstill, FindsAPersonWhoWaitsBehindPassingTrafficAndThenCrosses) {
  const Situation situation{.scans = 90, .movers = [](int scan) {
                              return std::vector<Cuboid>{person_at(22, -4 + path_length(scan, 50, 1.4)),
                                                         car_at(-30 + 1.2 * scan, -3)};
                            }};
  const FoundTraffic found = traffic_of(situation);
  EXPECT_GT(share_covered(situation, found.tracks, 0, situation.scans), 0.85) << "the car hides the person for some scans";
}

TEST(Standstill, LeavesWhatStandsForTheWholeDrive) {
  const Situation situation{.scans = 60,
                            .sensor_x = [](int scan) { return 0.6 * scan; },
                            .movers = [](int) { return std::vector<Cuboid>{car_at(25, 3), car_at(32, 3), person_at(20, -3)}; }};
  EXPECT_TRUE(traffic_of(situation).tracks.empty());
}

TEST(Contradictions, KeepScansWithWrongPosesOut) {
  const Situation situation{.scans = 24, .movers = [](int) { return std::vector<Cuboid>(); }, .yaw_error_deg = 6};
  const FoundTraffic found = traffic_of(situation);
  EXPECT_TRUE(found.tracks.empty());
  EXPECT_GT(found.contradictory.size(), 12U);
}

TEST(Contradictions, ScansThatAreNotTrustedFindNothing) {
  const Situation situation{.scans = 30, .movers = [](int scan) { return std::vector<Cuboid>{car_at(10 + 0.8 * scan, 1)}; }};
  const Drive drive = situation.drive();
  ScanPoses poses{drive.poses};
  const ground::ScanGround ground(drive, drive.poses);
  EXPECT_FALSE(find_traffic(drive, poses, ground, [] {}).tracks.empty());
  poses.untrusted = std::vector<bool>(30, true);
  EXPECT_TRUE(find_traffic(drive, poses, ground, [] {}).tracks.empty());
}

}  // namespace
}  // namespace dvi::objects
