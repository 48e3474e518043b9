#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dvi/core/hash.h"
#include "dvi/core/progress.h"
#include "dvi/detect/detector.h"
#include "dvi/io/reader.h"
#include "dvi/masks/masks.h"
#include "dvi/pipeline/job.h"

namespace dvi::pipeline {

/// A drive as it was opened: its data on demand, its poses as given, nothing estimated yet.
struct Recording {
  Drive drive;
  std::optional<masks::MaskSource> masks_from = {};       ///< none: nothing says what to remove, so nothing is
  std::shared_ptr<const detect::Detector> detector = {};  ///< where they are detected
  cv::Mat1b ego_mask = {};                                ///< removed in all frames, 255; empty: none
};

/// files, labels, detector, found or none, for a person.
std::string mask_source(const Recording& open);

/// The target first, then the source drives.
using Recordings = std::vector<Recording>;

/// Whether masks are needed. required: of a drive with neither masks nor labels, what moves is found in its scans; InputError
/// where there are none either. wanted: then a warning, and nothing is masked. optional: only masks and labels count; nothing
/// is found, and where there are none, nothing is masked.
enum class MaskNeed { required, wanted, optional };

/// Opens one drive as `source` says; warnings go to `progress`.
Recording open_recording(const fs::path& path, const ReadChoice& choice, MaskNeed need, Progress& progress);

/// Opens the target and the source drives. Ranges of frames, masks and poses given by hand are the target's; a detector is for
/// all. Where the target's masks are required, those of source drives are wanted. The ego mask also
/// holds for source drives whose camera has the name and size of the target's.
Recordings open_recordings(const Job& job, MaskNeed need, Progress& progress);

/// Opens the target for what needs images and masks only: its scans are left out, and a warning says that source drives are
/// not used.
Recordings open_images(const Job& job, Progress& progress);

/// Reads every image, mask file and scan once, so that damaged ones are found before hours of work. InputError at the first.
/// Warns, and returns the warnings, where the job's range of the LiDAR leaves out more than a tenth of a drive's returns.
std::vector<std::string> verify(const Recordings& drives, const Job& job, Progress& progress);

/// Adds the name of the drive, and name and content of every file that it is read from, wherever they lie. InputError where one
/// cannot be read.
void add_files(Fingerprint& print, const Drive& drive);

}  // namespace dvi::pipeline
