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

/// Limits for gaps between scans, and for motion across them.
struct GapParams {
  double min_gap_s = 1;       ///< as Trajectory::max_gap: no pose is interpolated across a longer gap
  double min_gap_steps = 3;   ///< in median steps from scan to scan
  double max_speed_mps = 60;  ///< across a gap; a registration that implies a higher speed is wrong
};
constexpr GapParams kGaps;

double to_s(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// A stretch with its poses.
struct Part {
  Stretch scans;
  odometry::Odometry odometry;
  Trajectory world_from_lidar;  ///< empty: no scan could be used
  bool placed = false;          ///< whether it is in the world of the other placed parts
};

Drive extract_stretch(const Drive& drive, const Stretch& scans) {
  Drive out = drive;
  out.scan_headers.assign(drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(scans.first),
                          drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(scans.last));
  out.scans = Lazy<Scan>::through(scans.last - scans.first,
                                  [all = drive.scans, first = scans.first](std::size_t i) { return all[first + i]; });
  return out;
}

bool has_given_pose(const Trajectory& given, const Trajectory& part) {
  return std::any_of(part.poses().begin(), part.poses().end(),
                     [&](const StampedPose& p) { return given.at(p.time_ns).has_value(); });
}

/// Aligns the parts that have given poses to these. If no part has, the longest part defines the world.
void place_first_parts(std::vector<Part>& parts, const Trajectory& given) {
  for (Part& part : parts)
    if (has_given_pose(given, part.world_from_lidar)) {
      part.world_from_lidar = align_to_given(given, part.world_from_lidar);
      part.placed = true;
    }
  const auto is_placed = [](const Part& part) { return part.placed; };
  if (std::any_of(parts.begin(), parts.end(), is_placed)) return;
  const auto shorter = [](const Part& a, const Part& b) {
    return a.world_from_lidar.poses().size() < b.world_from_lidar.poses().size();
  };
  std::max_element(parts.begin(), parts.end(), shorter)->placed = true;
}

enum class Parts { all, placed };

Trajectory join(const std::vector<Part>& parts, Parts which) {
  std::vector<StampedPose> poses;
  for (const Part& part : parts)
    if (part.placed || which == Parts::all)
      poses.insert(poses.end(), part.world_from_lidar.poses().begin(), part.world_from_lidar.poses().end());
  return Trajectory(std::move(poses));
}

/// Whether a vehicle can drive from one pose to the other in the time between them.
bool can_reach(const StampedPose& a, const StampedPose& b) {
  const double distance_m = (a.world_from_body.t - b.world_from_body.t).norm();
  return distance_m <= kGaps.max_speed_mps * to_s(std::abs(b.time_ns - a.time_ns));
}

/// Whether a vehicle can reach `part` from the poses of `base` before and after it.
bool is_plausible(const Trajectory& part, const Trajectory& base) {
  const StampedPose &first = part.poses().front(), &last = part.poses().back();
  const auto after = std::partition_point(base.poses().begin(), base.poses().end(),
                                          [&](const StampedPose& p) { return p.time_ns < first.time_ns; });
  return (after == base.poses().begin() || can_reach(*(after - 1), first)) &&
         (after == base.poses().end() || can_reach(last, *after));
}

/// Registers the parts that are not placed to the parts that are.
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
  const Trajectory base = join(parts, Parts::placed);
  if (open.empty() || base.empty()) return;
  const auto found = registration::register_drives({&drive, base, true, true}, tracks, options, progress.parts());
  progress.end();
  for (std::size_t k = 0; k < open.size(); ++k) {
    const registration::Placement& placement = found.sources[k];
    if (!placement.found() || !is_plausible(placement.world_from_lidar, base)) continue;
    open[k]->world_from_lidar = placement.world_from_lidar;
    open[k]->placed = true;
  }
}

/// Moves the parts that are not placed to the east of the others, kSeparationM apart.
void separate_unplaced(std::vector<Part>& parts) {
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
    part.world_from_lidar = part.world_from_lidar.in({Eigen::Matrix3d::Identity(), {east_m + kSeparationM - west_m, 0, 0}});
    extend(part.world_from_lidar);
  }
}

/// Returns "no scan for 5.1 s, between frames 29 and 80".
std::string describe_gap(const Drive& drive, const Stretch& before, const Stretch& after) {
  const std::int64_t from = drive.scan_headers[before.last - 1].time_ns, to = drive.scan_headers[after.first].time_ns;
  std::string words = fmt::format("no scan for {:.1f} s", to_s(to - from));
  if (drive.frames.empty()) return words;
  const auto last = nearest_in_time(drive.frames.begin(), drive.frames.end(), from);
  const auto first = nearest_in_time(drive.frames.begin(), drive.frames.end(), to);
  return words + fmt::format(", between frames {} and {}", last->number, first->number);
}

odometry::Odometry merge(const Drive& drive, std::vector<Part>& parts, Progress& progress) {
  odometry::Odometry out;
  for (std::size_t k = 1; k < parts.size(); ++k) {
    const std::string gap = describe_gap(drive, parts[k - 1].scans, parts[k].scans);
    if (parts[k - 1].placed && parts[k].placed)
      progress.note(drive.path.filename().string() + ": " + gap + ": poses or scans connect both sides");
    else
      out.warnings.push_back(gap +
                             ", and neither poses nor scans connect both sides: each side is filled from its own frames "
                             "only; give poses across the gap (--poses FILE) to copy across it");
  }
  out.world_from_lidar = join(parts, Parts::all);
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
  const double min_gap_s = steps.empty() ? kGaps.min_gap_s : std::max(kGaps.min_gap_s, kGaps.min_gap_steps * median(steps));
  std::vector<Stretch> out{{0, scans.size()}};
  for (std::size_t i = 1; i < scans.size(); ++i) {
    if (steps[i - 1] <= min_gap_s || (given.at(scans[i - 1].time_ns) && given.at(scans[i].time_ns))) continue;
    out.back().last = i;
    out.push_back({i, scans.size()});
  }
  return out;
}

odometry::Odometry estimate_odometry(const Drive& drive, const odometry::OdometryOptions& options, const Trajectory& given,
                                     Progress& progress) {
  const std::vector<Stretch> stretches = split_at_gaps(drive, given);
  // RGB-D odometry relocalizes a depth camera after a gap.
  if (stretches.size() == 1 || odometry::has_color_and_depth(drive))
    return odometry::estimate_odometry(drive, options, given, progress.parts());
  std::vector<Part> parts;
  for (const Stretch& scans : stretches) {
    Part part{scans, odometry::estimate_odometry(extract_stretch(drive, scans), options, given, progress.parts()), {}, false};
    part.world_from_lidar = part.odometry.world_from_lidar;
    parts.push_back(std::move(part));
  }
  place_first_parts(parts, given);
  register_parts(drive, options, parts, progress);
  separate_unplaced(parts);
  return merge(drive, parts, progress);
}

double path_length_m(const std::vector<StampedPose>& poses) {
  double length_m = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    if (const double step = (poses[i].world_from_body.t - poses[i - 1].world_from_body.t).norm(); step < kSeparationM)
      length_m += step;
  return length_m;
}

}  // namespace dvi::inputs
