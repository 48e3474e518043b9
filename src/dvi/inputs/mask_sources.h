#pragma once

#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/mask_source.h"
#include "dvi/job/job.h"

namespace dvi::inputs {

/// Whether masks are needed if a drive has neither masks nor labels. With `required` and `wanted`, moving objects are found in
/// its scans. Without scans, `required` throws InputError, and `wanted` warns and masks nothing. With `optional`, nothing is
/// masked.
enum class MaskNeed { required, wanted, optional };

/// Attaches the mask files and labels that `choice` names to an open drive, united per frame, and selects their classes.
/// Returns the sources of its masks, with MaskSource::detected if `choice` names a detector. Throws InputError if a named
/// source does not exist or does not fit the drive, and UsageError if sources contradict each other or remove nothing although
/// masks are required.
MaskSources attach_mask_sources(Drive& drive, const job::ReadChoice& choice, MaskNeed need);

/// Returns the sources that need no scans, which are those of the baselines.
MaskSources without_scans(MaskSources sources);

/// Replaces the mask files of a drive by the union of these folders, and of its own mask files if `and_own`. A frame has a mask
/// if any of them has one. Does nothing without folders.
void attach_mask_files(Drive& drive, const std::vector<job::MasksFrom>& folders, bool and_own, const job::ReadChoice& choice);

}  // namespace dvi::inputs
