#include "dvi/odometry/sharpness.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include <Eigen/Eigenvalues>

#include "dvi/core/median.h"
#include "dvi/drive/deskew.h"
#include "dvi/geometry/angles.h"
#include "dvi/geometry/moments.h"
#include "dvi/scan_match/voxel_key.h"

namespace dvi::odometry {

namespace {

struct PatchPoint {
  Eigen::Vector3f point;
  std::uint32_t scan;
};
using Patch = std::vector<PatchPoint>;

std::vector<std::size_t> select_sections(std::size_t scans) {
  std::vector<std::size_t> firsts;
  const std::size_t count = std::clamp<std::size_t>(scans / kSharpness.scans_per_section, 1, kSharpness.max_sections);
  for (std::size_t k = 0; k < count; ++k)
    firsts.push_back(count == 1 ? 0 : k * (scans - kSharpness.scans_per_section) / (count - 1));
  return firsts;
}

struct Plane {
  Eigen::Vector3d center, normal;
  double width = 0;
};

Plane fit_plane(const Patch& patch, const std::vector<bool>& inside) {
  Moments<double> moments;
  const Eigen::Vector3f origin = patch.front().point;
  for (std::size_t i = 0; i < patch.size(); ++i)
    if (inside[i]) moments.add((patch[i].point - origin).cast<double>());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance());
  return {origin.cast<double>() + moments.mean(), solver.eigenvectors().col(0),
          std::sqrt(std::max(solver.eigenvalues()[1], 0.0))};
}

/// Measures the signed square root of the variance between scans, and the normal. Returns false if the patch is not planar.
bool measure_patch(const Patch& patch, double& between_m, Eigen::Vector3d& normal) {
  if (patch.size() < kSharpness.min_points) return false;
  std::vector<bool> inside(patch.size(), true);
  Plane plane;
  for (int round = 0; round < 3; ++round) {
    plane = fit_plane(patch, inside);
    std::size_t count = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      inside[i] = std::abs((patch[i].point.cast<double>() - plane.center).dot(plane.normal)) < kSharpness.max_plane_distance_m;
      count += inside[i] ? 1 : 0;
    }
    if (static_cast<double>(count) < kSharpness.min_plane_share * static_cast<double>(patch.size())) return false;
  }
  if (plane.width < kSharpness.min_width_m) return false;
  double mean_of_means = 0, squared_means = 0, noise = 0;
  std::size_t scans = 0;
  for (std::size_t first = 0, last; first < patch.size(); first = last) {  // points are in the order of their scans
    double sum = 0, squares = 0;
    std::size_t n = 0;
    for (last = first; last < patch.size() && patch[last].scan == patch[first].scan; ++last) {
      if (!inside[last]) continue;
      const double d = (patch[last].point.cast<double>() - plane.center).dot(plane.normal);
      sum += d, squares += d * d, ++n;
    }
    if (n < kSharpness.min_points_per_scan) continue;
    const double count = static_cast<double>(n), mean = sum / count;
    mean_of_means += mean, squared_means += mean * mean, ++scans;
    noise += (squares - sum * mean) / (count - 1) / count;
  }
  if (scans < kSharpness.min_scans) return false;
  const double n = static_cast<double>(scans);
  const double variance = (squared_means - mean_of_means * mean_of_means / n) / (n - 1) - noise / n;
  between_m = std::copysign(std::sqrt(std::abs(variance)), variance);
  normal = plane.normal;
  return true;
}

}  // namespace

double Sharpness::total_m() const { return std::hypot(std::max(ground_m, 0.0), std::max(vertical_m, 0.0)); }

std::size_t count_sharpness_ticks(const Drive& drive) {
  return std::min(kSharpness.scans_per_section * select_sections(drive.scan_headers.size()).size(), drive.scan_headers.size());
}

Sharpness measure_sharpness(const Drive& drive, const Trajectory& world_from_lidar, const Tick& tick) {
  const double max_tilt = to_radians(kSharpness.max_tilt_deg);
  const double min_ground_z = std::cos(max_tilt), max_vertical_z = std::sin(max_tilt);
  std::vector<double> ground, vertical;
  for (const std::size_t first : select_sections(drive.scan_headers.size())) {
    std::unordered_map<scan_match::VoxelKey, Patch, scan_match::VoxelHash> patches;
    std::optional<SE3> here_from_world;
    const std::size_t last = std::min(first + kSharpness.scans_per_section, drive.scan_headers.size());
    for (std::size_t i = first; i < last; ++i) {
      const std::shared_ptr<const Scan> scan = drive.scans[i];
      const std::vector<Eigen::Vector3d> world =
          to_world(*scan, drive.scan_headers[i], world_from_lidar, kSharpness.point_step);
      if (!here_from_world && !world.empty()) here_from_world = world_from_lidar.at(drive.scan_headers[i].time_ns)->inverse();
      scan_match::VoxelKey last_key = 0;
      Patch* patch = nullptr;  // consecutive points mostly lie in the same patch
      for (std::size_t k = 0; k < world.size(); k += kSharpness.point_step) {
        const float range = scan->points[k].norm();
        if (range < kSharpness.min_range_m || range > kSharpness.max_range_m) continue;
        const Eigen::Vector3d p = *here_from_world * world[k];
        const scan_match::VoxelKey key = scan_match::voxel_key(p, kSharpness.patch_m);
        if (patch == nullptr || key != last_key) patch = &patches[key];
        last_key = key;
        patch->push_back({p.cast<float>(), static_cast<std::uint32_t>(i)});
      }
      tick();
    }
    for (const auto& [key, points] : patches) {
      double between = 0;
      Eigen::Vector3d normal;
      if (!measure_patch(points, between, normal)) continue;
      if (std::abs(normal.z()) > min_ground_z) ground.push_back(between);
      if (std::abs(normal.z()) < max_vertical_z) vertical.push_back(between);
    }
  }
  Sharpness out{median(ground), median(vertical), ground.size(), vertical.size()};
  return out;
}

}  // namespace dvi::odometry
