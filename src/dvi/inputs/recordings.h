#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/hash.h"
#include "dvi/core/progress.h"
#include "dvi/datasets/reader.h"
#include "dvi/job/job.h"
#include "dvi/objects/detect/detector.h"
#include "dvi/objects/label_masks.h"

namespace dvi::inputs {

/// A drive as one of its cameras saw it, as it was opened: its data on demand, its poses as given, nothing estimated yet.
struct Recording {
  Drive drive;
  std::optional<objects::MaskSource> masks_from = {};      ///< none: nothing says what to remove, so nothing is
  std::shared_ptr<const objects::Detector> detector = {};  ///< where they are detected
  cv::Mat1b ego_mask = {};                                 ///< removed in all frames, 255; empty: none
  bool gray = false;                                       ///< its images have no colors
  /// Of another camera of a drive: the number of that drive's own recording, whose scans, poses and moving objects it shares.
  std::optional<std::size_t> rig_of = {};
  /// Of such a camera: labels tell what stands in the view of the drive's own camera only. What they do not draw here, that is
  /// objects without a box and all that lies outside of that view, is carried over.
  bool labeled_in_part = false;
};

/// The name of its folder, and that of the camera where it is not the drive's own.
std::string name_of(const Recording& open);

/// files, labels, detector, found or none, for a person.
std::string mask_source(const Recording& open);

/// The target first, then the source drives, then other cameras of these (rig.h).
using Recordings = std::vector<Recording>;

/// Whether masks are needed. required: of a drive with neither masks nor labels, what moves is found in its scans; InputError
/// where there are none either. wanted: then a warning, and nothing is masked. optional: only masks and labels count; nothing
/// is found, and where there are none, nothing is masked.
enum class MaskNeed { required, wanted, optional };

/// Opens one drive as `source` says; warnings go to `progress`.
Recording open_recording(const fs::path& path, const job::ReadChoice& choice, MaskNeed need, Progress& progress);

/// Opens the target and the source drives, each with one camera. Ranges of frames, masks and poses given by hand are the
/// target's; a detector is for all. Where the target's masks are required, those of source drives are wanted. The ego mask also
/// holds for source drives whose camera has the name and size of the target's. Of source drives with given poses, only the
/// frames near the target are taken.
Recordings open_recordings(const job::Job& job, MaskNeed need, Progress& progress);

/// Opens the target for what needs images and masks only: its scans are left out, and a warning says that source drives are
/// not used.
Recordings open_images(const job::Job& job, Progress& progress);

/// Reads every image, mask file and scan once, so that damaged ones are found before hours of work. InputError at the first.
/// Warns, and returns the warnings, where the job's range of the LiDAR leaves out more than a tenth of a drive's returns.
std::vector<std::string> verify(const Recordings& drives, const job::Job& job, Progress& progress);

/// Every file that is read of it, wherever they lie; an empty path where a frame has no mask.
std::vector<fs::path> files_of(const Recording& open);

/// Adds the name of the drive, and name and content of every file of files_of(). InputError where one cannot be read.
void add_files(Fingerprint& print, const Recording& open);

}  // namespace dvi::inputs
