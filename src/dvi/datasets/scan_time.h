#pragma once

#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "dvi/drive/drive.h"
#include "dvi/media/point_cloud.h"
#include "dvi/media/point_times.h"

namespace dvi::datasets {

/// Which way a LiDAR turns, seen from above. `none`: its scans are compensated for the motion already.
enum class Turn { clockwise, counterclockwise, none };

/// How the azimuth atan2(y, x) of a return tells when within the scan it was measured.
struct Rotation {
  Turn turn = Turn::clockwise;
  double first_azimuth = std::numbers::pi;  ///< of the scan's first firing, radians
};

/// Seconds after the scan's stamp of each point, by its azimuth and the scan's start and end.
std::vector<float> times_by_azimuth(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header,
                                    const Rotation& rotation);

/// The same for points in order of time of a LiDAR that turns clockwise: the first point is at the scan's start, the last
/// one at its end. Returns fire a few degrees ahead of or behind each other, so that order decides at the seam.
std::vector<float> times_in_order(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header);

/// A scan from its file: with the times of the file by their meaning, or with times by azimuth where the file has none or they
/// are not usable.
/// `clock_offset_ns` was added to the times of the header, but not to those of the points. InputError where times are far from
/// the scan.
Scan to_scan(media::PointCloud cloud, const ScanHeader& header, const Rotation& rotation, const media::PointTimes& times = {},
             std::int64_t clock_offset_ns = 0);

}  // namespace dvi::datasets
