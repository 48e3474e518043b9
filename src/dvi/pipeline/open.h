#pragma once

#include <string>
#include <vector>

#include "dvi/core/hash.h"
#include "dvi/core/progress.h"
#include "dvi/io/reader.h"
#include "dvi/map/build_map.h"
#include "dvi/pipeline/choose_poses.h"
#include "dvi/pipeline/job.h"

namespace dvi::pipeline {

/// A drive that is ready for the stages once its poses are found.
struct OpenDrive {
  Drive drive;
  Lazy<cv::Mat1b> masks;        ///< as drive.frames
  Trajectory world_from_lidar;  ///< world: the target's first LiDAR pose
  PoseChoice poses;             ///< where they come from
};

/// Whether a drive must say what to remove; if not, nothing is masked where it does not.
enum class MaskNeed { required, optional };

/// Opens one drive as `source` says, with warnings told to `progress`. Poses are as given.
OpenDrive open_drive(const fs::path& path, const Source& source, MaskNeed need, const masks::MaskOptions& options,
                     Progress& progress);

/// Opens the target and the further drives. Their places in the world are still to be found.
std::vector<OpenDrive> open_drives(const Job& job, MaskNeed need, Progress& progress);

/// Finds the poses of each drive as the job asks, by LOAM where it is to be, and shares their world. InputError where a drive
/// has none.
void find_poses(std::vector<OpenDrive>& drives, const Job& job, Progress& progress);

/// Brings the poses of open drives, the target first, into the world of the target's first LiDAR pose. InputError where a drive
/// has no poses.
void share_world(std::vector<OpenDrive>& drives);

/// Opens the target for what needs images and masks only: its poses and scans are left out, further drives are told to be of
/// no use.
std::vector<OpenDrive> open_images(const Job& job, Progress& progress);

/// Reads every image, mask and scan once, so that bad ones are found before hours of work. InputError at the first.
void verify(const std::vector<OpenDrive>& drives, Progress& progress);

/// Adds every file that the drive is read from.
void add_files(Fingerprint& print, const Drive& drive);

/// The drives as the map sees them.
std::vector<map::MapInput> map_inputs(const std::vector<OpenDrive>& drives);

/// All posed frames of all drives. Frames without a pose are left out with a warning.
Views make_views(const std::vector<OpenDrive>& drives, Progress& progress);

/// All frames of all drives, whether posed or not, each with the identity for its pose: for what does not look at poses.
Views make_unposed_views(const std::vector<OpenDrive>& drives);

}  // namespace dvi::pipeline
