#pragma once

#include "dvi/datasets/scan_time.h"
#include "dvi/media/point_cloud.h"
#include "parser.h"

namespace dvi::fuzz {

/// Reads a file of points up to the scan that the pipeline gets.
inline void parse_scan(const fs::path& file) {
  media::PointCloud cloud = media::read_point_cloud(file);
  const std::size_t points = cloud.points.size();
  require(points > 0 && cloud.intensity.size() == points, "a point has an intensity");
  require(cloud.ring.empty() || cloud.ring.size() == points, "a point has a ring");
  for (const Eigen::Vector3f& p : cloud.points) require(p.allFinite(), "points are finite");
  const ScanHeader header{"0", 1'000'000'000, 950'000'000, 1'050'000'000, file};
  const Scan scan = datasets::to_scan(std::move(cloud), header, {});
  require(scan.time.size() == points, "a point has a time");
}

}  // namespace dvi::fuzz
