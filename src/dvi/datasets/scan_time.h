#pragma once

#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "dvi/drive/drive.h"
#include "dvi/media/point_cloud.h"
#include "dvi/media/point_times.h"

namespace dvi::datasets {

/// The direction in which a LiDAR rotates, seen from above. `none`: the scans are compensated for the motion already.
enum class Turn { clockwise, counterclockwise, none };

/// The relation between the azimuth atan2(y, x) of a return and the time within the scan at which it was measured.
struct Rotation {
  Turn turn = Turn::clockwise;
  double first_azimuth = std::numbers::pi;  ///< of the scan's first firing, in radians
};

/// Computes the time of each point in seconds after the scan's stamp, from its azimuth and the scan's start and end.
std::vector<float> times_by_azimuth(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header,
                                    const Rotation& rotation);

/// Computes the same for points in order of time of a LiDAR that rotates clockwise. The first point is at the scan's start and
/// the last one at its end. Since returns fire a few degrees ahead of or behind each other, the order of the points decides at
/// the seam.
std::vector<float> times_in_order(const std::vector<Eigen::Vector3f>& points, const ScanHeader& header);

/// How the times of the points in scan files are determined.
struct ScanClock {
  Rotation rotation;                 ///< used if the files have no usable times
  media::PointTimes times;           ///< the meaning of the times of the files
  std::int64_t clock_offset_ns = 0;  ///< that was added to the times of headers, but not to those of points
};

/// Makes a scan of the points of its file. Uses the times of the file according to their meaning, or times by azimuth if the
/// file has no usable times. Throws InputError if times are far from the scan.
Scan to_scan(media::PointCloud cloud, const ScanHeader& header, const ScanClock& clock);

}  // namespace dvi::datasets
