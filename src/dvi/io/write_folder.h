#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::io {

/// The files of the `folder` layout (docs/formats.md) for a drive: dvi.toml, times/, poses.txt and boxes.json, of its camera,
/// clocks, poses (those at the middle of its scans) and the boxes of its labels. dvi.toml comes last, so that a folder without
/// it is no drive yet. `more_cameras`: the same drive as its other cameras saw it, of which camera and times are written too;
/// the drive's own is the one a reader uses. Images, masks and scans are the caller's.
void write_folder_tables(const fs::path& folder, const Drive& drive, const std::vector<Drive>& more_cameras = {});

/// Scans a second as dvi.toml states them: by the median length of the scans; 10 where they have none.
double scan_rate(const Drive& drive);

/// Writes lidar/NAME.bin where the reader of such a file gives each point back its time (within 0.1 ms) by the azimuth,
/// clockwise from behind at `rate`; else lidar/NAME.ply with `t` (and `ring` where known).
void write_folder_scan(const fs::path& folder, const ScanHeader& header, const Scan& scan, double rate);

}  // namespace dvi::io
