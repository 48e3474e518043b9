#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The files of the `folder` layout (docs/formats.md) for a drive: dvi.toml, times/, poses.txt and boxes.json, of its camera,
/// clocks, given poses and labels, each as far as there are any. dvi.toml comes last, so that a folder without
/// it is no drive yet. `more_cameras`: the same drive as its other cameras saw it, of which camera and times are written too;
/// the drive's own is the one a reader uses. Images, masks and scans are the caller's.
void write_folder_tables(const fs::path& folder, const Drive& drive, const std::vector<Drive>& more_cameras = {});

/// Scans a second as dvi.toml states them: by the median length of the scans; 10 where they have none.
double scan_rate(const Drive& drive);

/// Writes lidar/NAME.bin where the reader of such a file gives each point back its time (within 0.1 ms) by the azimuth,
/// clockwise from behind; else lidar/NAME.ply with `t` (and `ring` where known).
void write_folder_scan(const fs::path& folder, const ScanHeader& header, const Scan& scan);

/// Writes a drive as such a folder: images and masks as their files are, or as PNG where the recording keeps them in files of
/// another kind; scans as above, depth images as their files are. `more_cameras` as above; `tick` is called for each image and
/// scan. The folder is whole or absent; InputError where it is there and not empty.
void write_folder(const fs::path& folder, const Drive& drive, const std::vector<Drive>& more_cameras, const Tick& tick);

}  // namespace dvi::datasets
