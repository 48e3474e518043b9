#pragma once

#include <string>

#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/scan_time.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The description of a drive's scan files. It is the same for all files of a drive.
struct ScanFiles {
  media::BinLayout bin;
  ScanClock clock;
  double units_per_meter = 1;

  Scan read(const ScanHeader& header) const;
};

/// Infers from up to three scans of a drive what its files do not declare: the columns of .bin files, the meaning of times, and
/// the unit of coordinates. Does not infer what `config` states. Adds a warning to the drive if anything differs from the
/// documented layout. Throws InputError, with the entry of dvi.toml to set, for what cannot be inferred. The headers must have
/// their final times. `rotation` is used if neither times nor `config` determine when points were measured.
ScanFiles inspect_scan_files(Drive& drive, const LidarConfig& config, const Rotation& rotation);

/// Lets a recording inspect its scan files after it is limited to the requested frames, and read them accordingly.
void attach_scan_files(DriveContents& recording, const LidarConfig& config, const Rotation& rotation);

/// Describes the files in lidar/ of a drive by their endings if none of them is a scan in a supported format: "20 .las".
/// Returns an empty text if there are no files.
std::string describe_other_scans(const fs::path& drive);

/// Throws InputError if a drive without scans, depth images and map has scans or a map in a format that is not supported.
void refuse_other_geometry(const fs::path& drive);

}  // namespace dvi::datasets
