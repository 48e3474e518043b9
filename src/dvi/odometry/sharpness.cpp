#include "dvi/odometry/sharpness.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include <Eigen/Eigenvalues>

#include "dvi/core/median.h"
#include "dvi/drive/deskew.h"
#include "dvi/geometry/moments.h"
#include "dvi/scan_match/voxel_key.h"

namespace dvi::odometry {

using namespace scan_match;

namespace {

constexpr std::size_t kStretch = 20, kStretches = 3;  // scans
constexpr std::size_t kPointStep = 2;                 // of the points
constexpr float kNearest = 3, kFarthest = 40;         // meters
constexpr double kPatch = 0.8;                        // meters, edge of the cubes
constexpr double kTolerance = 0.2;                    // meters off the plane: another thing
constexpr double kLeastInside = 0.85;                 // of a patch's points
constexpr double kLeastWidth = 0.12;                  // meters, standard deviation across: else it is a line
constexpr std::size_t kLeastScans = 5, kLeastPoints = 30, kLeastOfScan = 4;

struct Seen {
  Eigen::Vector3f point;
  std::uint32_t scan;
};
using Patch = std::vector<Seen>;

std::vector<std::size_t> stretches(std::size_t scans) {
  std::vector<std::size_t> firsts;
  const std::size_t count = std::clamp<std::size_t>(scans / kStretch, 1, kStretches);
  for (std::size_t k = 0; k < count; ++k) firsts.push_back(count == 1 ? 0 : k * (scans - kStretch) / (count - 1));
  return firsts;
}

struct Plane {
  Eigen::Vector3d center, normal;
  double width = 0;
};

Plane plane_of(const Patch& patch, const std::vector<bool>& inside) {
  Moments<double> moments;
  const Eigen::Vector3f origin = patch.front().point;
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (inside[i]) moments.add((patch[i].point - origin).cast<double>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance());
  return {origin.cast<double>() + moments.mean(), solver.eigenvectors().col(0),
          std::sqrt(std::max(solver.eigenvalues()[1], 0.0))};
}

// Signed square root of the variance between scans, and the plane's normal; false where the patch is no plane.
bool measure(const Patch& patch, double& between_m, Eigen::Vector3d& normal) {
  if (patch.size() < kLeastPoints) return false;
  std::vector<bool> inside(patch.size(), true);
  Plane plane;
  for (int round = 0; round < 3; ++round) {
    plane = plane_of(patch, inside);
    std::size_t count = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      inside[i] = std::abs((patch[i].point.cast<double>() - plane.center).dot(plane.normal)) < kTolerance;
      count += inside[i] ? 1 : 0;
    }
    if (static_cast<double>(count) < kLeastInside * static_cast<double>(patch.size())) return false;
  }
  if (plane.width < kLeastWidth) return false;
  double mean_of_means = 0, squared_means = 0, noise = 0;
  std::size_t scans = 0;
  for (std::size_t first = 0, last; first < patch.size(); first = last) {  // points lie in the order of their scans
    double sum = 0, squares = 0;
    std::size_t n = 0;
    for (last = first; last < patch.size() && patch[last].scan == patch[first].scan; ++last) {
      if (!inside[last]) continue;
      const double d = (patch[last].point.cast<double>() - plane.center).dot(plane.normal);
      sum += d, squares += d * d, ++n;
    }
    if (n < kLeastOfScan) continue;
    const double count = static_cast<double>(n), mean = sum / count;
    mean_of_means += mean, squared_means += mean * mean, ++scans;
    noise += (squares - sum * mean) / (count - 1) / count;
  }
  if (scans < kLeastScans) return false;
  const double n = static_cast<double>(scans);
  const double variance = (squared_means - mean_of_means * mean_of_means / n) / (n - 1) - noise / n;
  between_m = std::copysign(std::sqrt(std::abs(variance)), variance);
  normal = plane.normal;
  return true;
}

}  // namespace

double Sharpness::total_m() const { return std::hypot(std::max(ground_m, 0.0), std::max(vertical_m, 0.0)); }

std::size_t sharpness_ticks(const Drive& drive) {
  return std::min(kStretch * stretches(drive.scan_headers.size()).size(), drive.scan_headers.size());
}

Sharpness sharpness(const Drive& drive, const Trajectory& world_from_lidar, const Tick& tick) {
  const double kUpright = std::cos(10 * M_PI / 180), kFlat = std::sin(10 * M_PI / 180);
  std::vector<double> ground, vertical;
  for (const std::size_t first : stretches(drive.scan_headers.size())) {
    std::unordered_map<scan_match::VoxelKey, Patch, scan_match::VoxelHash> patches;
    std::optional<SE3> here_from_world;
    const std::size_t last = std::min(first + kStretch, drive.scan_headers.size());
    for (std::size_t i = first; i < last; ++i) {
      const std::shared_ptr<const Scan> scan = drive.scans[i];
      const std::vector<Eigen::Vector3d> world = to_world(*scan, drive.scan_headers[i], world_from_lidar, kPointStep);
      if (!here_from_world && !world.empty()) here_from_world = world_from_lidar.at(drive.scan_headers[i].time_ns)->inverse();
      scan_match::VoxelKey last_key = 0;
      Patch* patch = nullptr;  // neighbors of a beam mostly lie in one
      for (std::size_t k = 0; k < world.size(); k += kPointStep) {
        const float range = scan->points[k].norm();
        if (range < kNearest || range > kFarthest) continue;
        const Eigen::Vector3d p = *here_from_world * world[k];
        const scan_match::VoxelKey key = scan_match::voxel_key(p, kPatch);
        if (patch == nullptr || key != last_key) patch = &patches[key];
        last_key = key;
        patch->push_back({p.cast<float>(), static_cast<std::uint32_t>(i)});
      }
      tick();
    }
    for (const auto& [key, seen] : patches) {
      double between = 0;
      Eigen::Vector3d normal;
      if (!measure(seen, between, normal)) continue;
      if (std::abs(normal.z()) > kUpright) ground.push_back(between);
      if (std::abs(normal.z()) < kFlat) vertical.push_back(between);
    }
  }
  Sharpness out{median(ground), median(vertical), ground.size(), vertical.size()};
  return out;
}

}  // namespace dvi::odometry
