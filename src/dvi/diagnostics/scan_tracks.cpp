#include "dvi/diagnostics/scan_tracks.h"

#include <algorithm>
#include <optional>

#include "dvi/core/threads.h"

namespace dvi::diagnostics {
namespace {

Drive extract_section(const Drive& drive, std::size_t first, std::size_t last) {
  Drive out;
  out.scan_headers.assign(drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(first),
                          drive.scan_headers.begin() + static_cast<std::ptrdiff_t>(last));
  out.scans = Lazy<Scan>::through(last - first, [scans = drive.scans, first](std::size_t i) { return scans[first + i]; });
  return out;
}

bool is_constrained(const odometry::ScanFit& fit) {
  using State = odometry::ScanFit::State;
  return fit.state == State::first || (fit.state == State::registered && fit.degenerate == 0);
}

std::optional<ScanTrack> estimate_track(const Drive& drive, std::size_t first, std::size_t last,
                                        const odometry::OdometryOptions& options) {
  const odometry::Odometry found = odometry::estimate_odometry(extract_section(drive, first, last), options);
  if (found.world_from_lidar.poses().size() < kScanTrack.min_scans ||
      !std::all_of(found.scans.begin(), found.scans.end(), is_constrained))
    return std::nullopt;
  return ScanTrack{first, last, found.world_from_lidar};
}

}  // namespace

std::size_t count_scan_track_ticks(const Drive& drive) {
  const std::size_t scans = drive.scan_headers.size();
  return scans < kScanTrack.min_scans ? 0 : std::clamp<std::size_t>(scans / kScanTrack.scans, 1, kScanTrack.max_sections);
}

std::vector<ScanTrack> estimate_scan_tracks(const Drive& drive, odometry::OdometryOptions options, const Tick& tick) {
  options.loops = false;
  const std::size_t scans = drive.scan_headers.size(), count = count_scan_track_ticks(drive);
  std::vector<std::optional<ScanTrack>> found(count);
  parallel_for(count, [&](std::size_t k) {
    const std::size_t first = count == 1 ? 0 : k * (scans - kScanTrack.scans) / (count - 1);
    found[k] = estimate_track(drive, first, std::min(first + kScanTrack.scans, scans), options);
    tick();
  });
  std::vector<ScanTrack> out;
  for (std::optional<ScanTrack>& track : found)
    if (track) out.push_back(std::move(*track));
  return out;
}

}  // namespace dvi::diagnostics
