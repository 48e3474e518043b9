#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/core/interrupt.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// Writes the text files of the `folder` layout (docs/formats.md) for a drive: dvi.toml, times/, poses.txt and boxes.json, with
/// its camera, clocks, given poses and labels as far as they exist. dvi.toml is written last, so that a folder without it is
/// not a drive yet. `more_cameras` are the same drive with its other cameras, of which camera and times are written as well; a
/// reader uses the camera of `drive` by default. The caller writes images, masks and scans.
void write_folder_tables(const fs::path& folder, const Drive& drive, const std::vector<Drive>& more_cameras = {});

/// Returns the rate of scans for dvi.toml: the inverse of their median length, or 10 per second if they have none.
double compute_scan_rate(const Drive& drive);

/// Writes lidar/NAME.bin if the times of all points follow (within 0.1 ms) from their azimuth, clockwise from behind; otherwise
/// writes lidar/NAME.ply with `t` (and `ring` if known).
void write_folder_scan(const fs::path& folder, const ScanHeader& header, const Scan& scan);

/// Writes a drive in this layout. Copies image and mask files, or writes PNG if the recording keeps them in files of another
/// kind; writes scans as above and copies depth images. `more_cameras` is as above; `tick` is called for each image and scan.
/// The folder is complete or absent. Throws InputError if it exists and is not empty.
void write_folder(const fs::path& folder, const Drive& drive, const std::vector<Drive>& more_cameras, const Tick& tick);

}  // namespace dvi::datasets
