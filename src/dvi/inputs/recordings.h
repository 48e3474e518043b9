#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/hash.h"
#include "dvi/core/progress.h"
#include "dvi/datasets/reader.h"
#include "dvi/drive/mask_source.h"
#include "dvi/inputs/mask_sources.h"
#include "dvi/job/job.h"
#include "dvi/objects/detect/detector.h"

namespace dvi::inputs {

/// A drive as observed by one of its cameras. Images and scans are read on demand, and poses are as given.
struct Recording {
  Drive drive;
  MaskSources masks_from = {};                             ///< empty: nothing is removed
  std::shared_ptr<const objects::Detector> detector = {};  ///< if masks are detected
  cv::Mat1b ego_mask = {};                                 ///< 255 on the ego vehicle in all frames; empty: none
  bool gray = false;                                       ///< its images have no colors
  /// For another camera of a drive: the index of the drive's own recording, whose scans, poses, and moving objects it shares.
  std::optional<std::size_t> rig_of = {};
  /// For such a camera: the labels cover the view of the drive's own camera only. Objects without a box, and objects outside of
  /// that view, are reprojected.
  bool labeled_in_part = false;
  bool is_cleaned = false;  ///< a camera of the target whose frames are filled
};

/// Returns the name of the drive's folder, followed by the name of the camera if it is another camera of the drive.
std::string name_of(const Recording& open);

/// Returns the names of the mask sources, such as "files, found"; "none" if there are none.
std::string mask_source(const Recording& open);

/// The target, then its other cleaned cameras, then the source drives, then other cameras of these (rig.h).
using Recordings = std::vector<Recording>;

/// Opens one drive as `choice` describes. Warnings go to `progress`.
Recording open_recording(const fs::path& path, const job::ReadChoice& choice, MaskNeed need, Progress& progress);

/// Opens the target and the source drives, each with one camera. The job's range of frames, masks, and poses apply to the
/// target only, its detector and `--masks none` to all drives. If masks of the target are required, those of source drives are
/// wanted. The ego mask also applies to source drives whose camera has the name and size of the target's camera. Of source
/// drives with given poses, only the part near the target is read (near_target.h).
Recordings open_recordings(const job::Job& job, MaskNeed need, Progress& progress);

/// Opens the target for methods that use images and masks only. Scans are left out, and a warning reports source drives, which
/// are not used. Throws InputError if the drive has neither masks nor labels.
Recordings open_images(const job::Job& job, Progress& progress);

/// Divides the job's memory for the largest images of the drives. Returns a warning if it is too small for one frame.
std::optional<std::string> bound_memory(const job::Job& job, const Recordings& drives);

/// Reads every image, mask file, and scan once, so that damaged files are reported before hours of work. Throws InputError for
/// the first damaged file, and for a map that is not near its drive's path. Warns, and returns the warnings, if the LiDAR's
/// range in the job excludes more than a tenth of a drive's returns, or if scans may be truncated.
std::vector<std::string> verify(const Recordings& drives, const job::Job& job, Progress& progress);

/// Throws InputError if the provenance, whose values have 16 bits, cannot hold the number of a source image, or a position in
/// it in sixteenths of a pixel.
void require_provenance_range(const Recordings& drives);

/// Lists every file that is read of a recording, with an empty path for each frame without a mask.
std::vector<fs::path> files_of(const Recording& open);

/// Adds the name of the drive, and the name and content of every file of files_of() to a fingerprint. Throws InputError if a
/// file cannot be read.
void add_files(Fingerprint& print, const Recording& open);

}  // namespace dvi::inputs
