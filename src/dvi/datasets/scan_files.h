#pragma once

#include <string>

#include "dvi/datasets/drive_config.h"
#include "dvi/datasets/reader.h"
#include "dvi/datasets/scan_time.h"
#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// How the scan files of a drive are read. One description holds for all files of a drive.
struct ScanFiles {
  media::BinLayout bin;
  Rotation rotation;
  media::PointTimes times;
  std::int64_t clock_offset_ns = 0;
  double units_per_meter = 1;

  Scan read(const ScanHeader& header) const;
};

/// Infers from up to three scans of a drive what their files do not declare: the columns of .bin files, the meaning of times,
/// the unit of coordinates. What `config` states is not inferred. What is not as the documentation asks for is added to the
/// warnings of the drive; InputError for what cannot be inferred, with the entry of dvi.toml that states it. The headers have
/// their final times; `rotation` holds where neither times nor `config` say when points were measured.
ScanFiles inspect_scan_files(Drive& drive, const LidarConfig& config, const Rotation& rotation);

/// Lets a recording inspect its scan files, once it is cut to the frames asked for, and read them so.
void attach_scan_files(DriveContents& recording, const LidarConfig& config, const Rotation& rotation);

/// Describes the files in lidar/ of a drive by their endings, where none of them is a scan in a format that is read: "20 .las".
/// Empty where there are no files.
std::string describe_other_scans(const fs::path& drive);

/// Throws InputError where a drive without scans, depth images and a map has scans or a map in a format that is not read.
void refuse_other_geometry(const fs::path& drive);

}  // namespace dvi::datasets
