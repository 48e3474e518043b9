#include "dvi/diagnostics/scan_tracks.h"

#include <algorithm>
#include <optional>

#include "dvi/core/threads.h"

namespace dvi::diagnostics {
namespace {

constexpr std::size_t kStretch = 20, kStretches = 3;  // scans
constexpr std::size_t kFewestScans = 5;               // scans

Drive stretch_of(const Drive& drive, std::size_t first, std::size_t last) {
  Drive out;
  out.scan_headers.assign(drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(first),
                          drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(last));
  out.scans = Lazy<Scan>::through(last - first, [scans = drive.scans, first](std::size_t i) { return scans[first + i]; });
  return out;
}

bool holds(const odometry::ScanFit& fit) {
  using State = odometry::ScanFit::State;
  return fit.state == State::first || (fit.state == State::registered && fit.degenerate == 0);
}

std::optional<ScanTrack> track_of(const Drive& drive, std::size_t first, std::size_t last,
                                  const odometry::OdometryOptions& options) {
  const odometry::Odometry found = odometry::estimate_odometry(stretch_of(drive, first, last), options);
  if (found.world_from_lidar.poses().size() < kFewestScans || !std::all_of(found.scans.begin(), found.scans.end(), holds))
    return std::nullopt;
  return ScanTrack{first, last, found.world_from_lidar};
}

}  // namespace

std::size_t scan_tracks_ticks(const Drive& drive) {
  const std::size_t scans = drive.scan_headers.size();
  return scans < kFewestScans ? 0 : std::clamp<std::size_t>(scans / kStretch, 1, kStretches);
}

std::vector<ScanTrack> scan_tracks(const Drive& drive, odometry::OdometryOptions options, const Tick& tick) {
  options.loops = false;
  const std::size_t scans = drive.scan_headers.size(), count = scan_tracks_ticks(drive);
  std::vector<std::optional<ScanTrack>> found(count);
  parallel_for(count, [&](std::size_t k) {
    const std::size_t first = count == 1 ? 0 : k * (scans - kStretch) / (count - 1);
    found[k] = track_of(drive, first, std::min(first + kStretch, scans), options);
    tick();
  });
  std::vector<ScanTrack> out;
  for (std::optional<ScanTrack>& track : found)
    if (track) out.push_back(std::move(*track));
  return out;
}

}  // namespace dvi::diagnostics
