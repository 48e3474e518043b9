#include "dvi/inputs/stretches.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "dvi/core/median.h"
#include "dvi/drive/nearest_in_time.h"
#include "dvi/inputs/choose_poses.h"
#include "dvi/odometry/rgbd_odometry.h"
#include "dvi/registration/registration.h"

namespace dvi::inputs {
namespace {

constexpr double kMinGapS = 1;       // Trajectory::max_gap: no pose is interpolated across more
constexpr double kMinGapSteps = 3;   // usual steps from scan to scan
constexpr double kMaxSpeedMps = 60;  // across a gap: a faster registration is a wrong one

double to_s(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// A stretch with its poses.
struct Part {
  Stretch scans;
  odometry::Odometry odometry;
  Trajectory world_from_lidar;  ///< empty: no scan could be used
  bool placed = false;          ///< in the world of the other placed parts
};

Drive drive_of(const Drive& drive, const Stretch& scans) {
  Drive out = drive;
  out.scan_headers.assign(drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(scans.first),
                          drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(scans.last));
  out.scans = Lazy<Scan>::through(scans.last - scans.first,
                                  [all = drive.scans, first = scans.first](std::size_t i) { return all[first + i]; });
  return out;
}

bool has_given(const Trajectory& given, const Trajectory& part) {
  return std::any_of(part.poses().begin(), part.poses().end(),
                     [&](const StampedPose& p) { return given.at(p.time_ns).has_value(); });
}

/// Places the parts with given poses by these; if there are none, the longest is where it is.
void place_first(std::vector<Part>& parts, const Trajectory& given) {
  for (Part& part : parts)
    if (has_given(given, part.world_from_lidar)) {
      part.world_from_lidar = laid_onto(given, part.world_from_lidar);
      part.placed = true;
    }
  const auto is_placed = [](const Part& part) { return part.placed; };
  if (std::any_of(parts.begin(), parts.end(), is_placed)) return;
  const auto shorter = [](const Part& a, const Part& b) {
    return a.world_from_lidar.poses().size() < b.world_from_lidar.poses().size();
  };
  std::max_element(parts.begin(), parts.end(), shorter)->placed = true;
}

Trajectory joined(const std::vector<Part>& parts, bool placed_only) {
  std::vector<StampedPose> poses;
  for (const Part& part : parts)
    if (part.placed || !placed_only)
      poses.insert(poses.end(), part.world_from_lidar.poses().begin(), part.world_from_lidar.poses().end());
  return Trajectory(std::move(poses));
}

/// Whether a drive can have come from one pose to the other.
bool can_reach(const StampedPose& a, const StampedPose& b) {
  const double distance_m = (a.world_from_body.t - b.world_from_body.t).norm();
  return distance_m <= kMaxSpeedMps * to_s(std::abs(b.time_ns - a.time_ns));
}

bool plausible(const Trajectory& part, const Trajectory& base) {
  const StampedPose &first = part.poses().front(), &last = part.poses().back();
  const auto after = std::partition_point(base.poses().begin(), base.poses().end(),
                                          [&](const StampedPose& p) { return p.time_ns < first.time_ns; });
  return (after == base.poses().begin() || can_reach(*(after - 1), first)) &&
         (after == base.poses().end() || can_reach(last, *after));
}

/// Registers the parts that are not placed yet to those that are.
void register_parts(const Drive& drive, const odometry::OdometryOptions& options, std::vector<Part>& parts,
                    Progress& progress) {
  if (drive.sensor != Sensor::lidar) return;
  std::vector<Part*> open;
  std::vector<registration::DriveTrack> tracks;
  for (Part& part : parts)
    if (!part.placed && !part.world_from_lidar.empty()) {
      open.push_back(&part);
      tracks.push_back({&drive, part.world_from_lidar, false});
    }
  const Trajectory base = joined(parts, true);
  if (open.empty() || base.empty()) return;
  const auto found = registration::register_drives({&drive, base, true}, tracks, options, true, progress.parts());
  progress.end();
  for (std::size_t k = 0; k < open.size(); ++k) {
    const registration::Placement& placement = found.sources[k];
    if (!placement.found() || !plausible(placement.world_from_lidar, base)) continue;
    open[k]->world_from_lidar = placement.world_from_lidar;
    open[k]->placed = true;
  }
}

/// Moves the parts that are not placed beside the others, one after the other.
void put_apart(std::vector<Part>& parts) {
  double east_m = -std::numeric_limits<double>::infinity();
  const auto extend = [&](const Trajectory& part) {
    for (const StampedPose& p : part.poses()) east_m = std::max(east_m, p.world_from_body.t.x());
  };
  for (const Part& part : parts)
    if (part.placed) extend(part.world_from_lidar);
  for (Part& part : parts) {
    if (part.placed || part.world_from_lidar.empty()) continue;
    double west_m = std::numeric_limits<double>::infinity();
    for (const StampedPose& p : part.world_from_lidar.poses()) west_m = std::min(west_m, p.world_from_body.t.x());
    part.world_from_lidar = part.world_from_lidar.in({Eigen::Matrix3d::Identity(), {east_m + kApartM - west_m, 0, 0}});
    extend(part.world_from_lidar);
  }
}

/// "no scan for 5.1 s, between frames 29 and 80"
std::string describe_gap(const Drive& drive, const Stretch& before, const Stretch& after) {
  const std::int64_t from = drive.scan_headers[before.last - 1].time_ns, to = drive.scan_headers[after.first].time_ns;
  std::string words = fmt::format("no scan for {:.1f} s", to_s(to - from));
  if (drive.frames.empty()) return words;
  const auto last = nearest_in_time(drive.frames.begin(), drive.frames.end(), from);
  const auto first = nearest_in_time(drive.frames.begin(), drive.frames.end(), to);
  return words + fmt::format(", between frames {} and {}", last->number, first->number);
}

odometry::Odometry merged(const Drive& drive, std::vector<Part>& parts, Progress& progress) {
  odometry::Odometry out;
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const std::string gap = describe_gap(drive, parts[k - 1].scans, parts[k].scans);
    if (parts[k - 1].placed && parts[k].placed)
      progress.note(drive.path.filename().string() + ": " + gap + ": poses or scans tie both sides together");
    else
      out.warnings.push_back(gap +
                             ", and neither poses nor scans tie both sides together: each side is filled from itself alone; "
                             "give poses across the gap (--poses FILE) to copy across it");
  }
  out.world_from_lidar = joined(parts, false);
  for (Part& part : parts) {
    odometry::Odometry& one = part.odometry;
    out.scans.insert(out.scans.end(), one.scans.begin(), one.scans.end());
    out.plane_features += one.plane_features;
    out.edge_features += one.edge_features;
    if (out.rings.empty()) out.rings = one.rings;
    out.warnings.insert(out.warnings.end(), one.warnings.begin(), one.warnings.end());
    out.loops += one.loops;
    out.largest_correction_m = std::max(out.largest_correction_m, one.largest_correction_m);
  }
  return out;
}

}  // namespace

std::vector<Stretch> split_at_gaps(const Drive& drive, const Trajectory& given) {
  const std::vector<ScanHeader>& scans = drive.scan_headers;
  std::vector<double> steps;
  for (std::size_t i = 1; i < scans.size(); ++i) steps.push_back(to_s(scans[i].time_ns - scans[i - 1].time_ns));
  const double min_gap_s = steps.empty() ? kMinGapS : std::max(kMinGapS, kMinGapSteps * median(steps));
  std::vector<Stretch> out{{0, scans.size()}};
  for (std::size_t i = 1; i < scans.size(); ++i) {
    if (steps[i - 1] <= min_gap_s || (given.at(scans[i - 1].time_ns) && given.at(scans[i].time_ns))) continue;
    out.back().last = i;
    out.push_back({i, scans.size()});
  }
  return out;
}

odometry::Odometry odometry_of_stretches(const Drive& drive, const odometry::OdometryOptions& options, const Trajectory& given,
                                         Progress& progress) {
  const std::vector<Stretch> stretches = split_at_gaps(drive, given);
  // A depth camera with color images is found again after a gap by what it sees.
  if (stretches.size() == 1 || odometry::has_color_and_depth(drive))
    return odometry::estimate_odometry(drive, options, given, progress.parts());
  std::vector<Part> parts;
  for (const Stretch& scans : stretches) {
    Part part{scans, odometry::estimate_odometry(drive_of(drive, scans), options, given, progress.parts()), {}, false};
    part.world_from_lidar = part.odometry.world_from_lidar;
    parts.push_back(std::move(part));
  }
  place_first(parts, given);
  register_parts(drive, options, parts, progress);
  put_apart(parts);
  return merged(drive, parts, progress);
}

double path_length_m(const std::vector<StampedPose>& poses) {
  double length_m = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (const double step = (poses[i].world_from_body.t - poses[i - 1].world_from_body.t).norm(); step < kApartM)
      length_m += step;
  return length_m;
}

}  // namespace dvi::inputs
