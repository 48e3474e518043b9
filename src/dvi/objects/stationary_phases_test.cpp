#include "dvi/objects/stationary_phases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "dvi/core/random.h"
#include "dvi/objects/motion_segmentation.h"
#include "dvi/objects/plain_drive.h"

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
  double yaw_error_deg = 0;  // random error of each pose

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
    std::vector<Cuboid> surfaces = houses();
    surfaces.push_back(parked());
    for (const Cuboid& mover : movers(static_cast<int>(i))) surfaces.push_back(mover);
    const Eigen::Vector3d sensor = pose(static_cast<int>(i)).t;
    Random random(i + 1);
    Scan scan;
    for (double up = -20; up <= 3; up += degrees_between_beams)
      for (double aside = -180; aside < 180; aside += 0.5) {
        const Eigen::Vector3d ray(std::cos(aside * kDegree) * std::cos(up * kDegree),
                                  std::sin(aside * kDegree) * std::cos(up * kDegree), std::sin(up * kDegree));
        double length = ray.z() < 0 ? -sensor.z() / ray.z() : 1e9;
        for (const Cuboid& surface : surfaces) length = std::min(length, intersect(surface, sensor, ray));
        if (length > 90) continue;
        scan.points.emplace_back(((length + 0.02 * random.normal()) * ray).cast<float>());
        scan.time.push_back(0);
        scan.intensity.push_back(0.5F);
      }
    return scan;
  }

  Drive drive() const {
    Drive out = PlainDrive(scans, 0).drive;
    std::vector<StampedPose> poses;
    Random random(7);
    for (int i = 0; i < scans; ++i) {
      SE3 at = pose(i);
      at.R = Eigen::AngleAxisd(yaw_error_deg * random.normal() * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()).matrix();
      poses.push_back({i * PlainDrive::kScanPeriodNs, at});
    }
    out.poses = Trajectory(poses);
    out.scans = Lazy<Scan>(static_cast<std::size_t>(scans), static_cast<std::size_t>(scans),
                           [self = *this](std::size_t i) { return self.measure(i); });
    return out;
  }

 private:
  static double intersect(const Cuboid& cuboid, const Eigen::Vector3d& sensor, const Eigen::Vector3d& ray) {
    const Eigen::Array3d a = (cuboid.min() - sensor).array() / ray.array(), b = (cuboid.max() - sensor).array() / ray.array();
    const double enter = a.min(b).maxCoeff(), leave = a.max(b).minCoeff();
    return enter > 0 && enter < leave ? enter : 1e9;
  }
};

MotionSegmentation segment(const Drive& drive, const ScanPoses& poses) {
  const ground::ScanGround ground(drive, drive.poses);
  MovingReturns returns(drive, poses, ground);
  return segment_motion(returns, [] {});
}

MotionSegmentation segment(const Situation& situation) {
  const Drive drive = situation.drive();
  return segment(drive, {drive.poses});
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
    const MotionSegmentation found = segment(situation);
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
  const MotionSegmentation found = segment(situation);
  EXPECT_GT(compute_covered_share(situation, found.tracks, 0, situation.scans), 0.95);
  expect_parked_car_remains(found.tracks);
}

TEST(StationaryPhases, FindsACarThatArrivesAndStopsUntilTheEnd) {
  const Situation situation{.scans = 80, .movers = [](int scan) {
                              return std::vector<Cuboid>{car_at(30 - compute_path_length(80 - scan, 50, 8), 1)};
                            }};
  const MotionSegmentation found = segment(situation);
  EXPECT_GT(compute_covered_share(situation, found.tracks, 0, situation.scans), 0.95);
  expect_parked_car_remains(found.tracks);
}

TEST(StationaryPhases, FindsAPersonWhoWaitsBehindPassingTrafficAndThenCrosses) {
  const Situation situation{.scans = 90, .movers = [](int scan) {
                              return std::vector<Cuboid>{person_at(22, -4 + compute_path_length(scan, 50, 1.4)),
                                                         car_at(-30 + 1.2 * scan, -3)};
                            }};
  const MotionSegmentation found = segment(situation);
  EXPECT_GT(compute_covered_share(situation, found.tracks, 0, situation.scans), 0.85)
      << "the car hides the person for some scans";
}

TEST(StationaryPhases, IgnoresObjectsThatAreStationaryForTheWholeDrive) {
  const Situation situation{.scans = 60,
                            .sensor_x = [](int scan) { return 0.6 * scan; },
                            .movers = [](int) { return std::vector<Cuboid>{car_at(25, 3), car_at(32, 3), person_at(20, -3)}; }};
  EXPECT_TRUE(segment(situation).tracks.empty());
}

TEST(Contradictions, ExcludeScansWithWrongPoses) {
  const Situation situation{.scans = 24, .movers = [](int) { return std::vector<Cuboid>(); }, .yaw_error_deg = 6};
  const MotionSegmentation found = segment(situation);
  EXPECT_TRUE(found.tracks.empty());
  EXPECT_GT(found.contradictory_scans.size(), 12U);
}

TEST(Contradictions, UntrustedScansAreNotUsed) {
  const Situation situation{.scans = 30, .movers = [](int scan) { return std::vector<Cuboid>{car_at(10 + 0.8 * scan, 1)}; }};
  const Drive drive = situation.drive();
  ScanPoses poses{drive.poses};
  EXPECT_FALSE(segment(drive, poses).tracks.empty());
  poses.untrusted = std::vector<bool>(30, true);
  EXPECT_TRUE(segment(drive, poses).tracks.empty());
}

}  // namespace
}  // namespace dvi::objects
