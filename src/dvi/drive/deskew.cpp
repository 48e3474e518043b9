#include "dvi/drive/deskew.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dvi {
namespace {

// The number of poses within a scan: 0.2 ms each at 10 Hz, or 3 mm at 15 m/s.
constexpr int kSlices = 256;

}  // namespace

std::vector<Eigen::Vector3d> to_world(const Scan& scan, const ScanHeader& header, const Trajectory& world_from_lidar,
                                      std::size_t every) {
  const auto [first, last] = std::minmax_element(scan.time.begin(), scan.time.end());
  if (first == scan.time.end()) return {};
  const double begin = *first, span = std::max(1e-9, static_cast<double>(*last) - *first);
  const auto pose_after = [&](double seconds) {
    return world_from_lidar.at(header.time_ns + static_cast<std::int64_t>(std::llround(seconds * 1e9)));
  };
  if (!pose_after(begin) || !pose_after(begin + span)) return {};
  std::vector<std::optional<SE3>> slices(kSlices + 1);
  std::vector<Eigen::Vector3d> world(scan.size());
  for (std::size_t i = 0; i < scan.size(); i += every) {
    const int slice = static_cast<int>(std::lround((scan.time[i] - begin) / span * kSlices));
    std::optional<SE3>& pose = slices[slice];
    if (!pose) pose = pose_after(begin + span * slice / kSlices);
    if (!pose) return {};
    world[i] = *pose * scan.points[i].cast<double>();
  }
  return world;
}

}  // namespace dvi
