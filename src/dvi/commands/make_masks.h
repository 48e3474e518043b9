#pragma once

#include <string>
#include <vector>

#include "dvi/core/progress.h"
#include "dvi/job/job.h"

namespace dvi::commands {

/// Runs `dvi mask`: finds the objects that a run removes from job.target, and writes job.out/masks/CAMERA/NAME.png, which
/// `--masks` reads, contact.png, masks.json, and the masks as polygons in coco.json and annotations.xml (CVAT). Returns
/// masks.json. With several cameras (job.read.camera), each has its sheet and lists in job.out/CAMERA, and those of all are
/// returned. Throws InputError if job.out is not empty, or is, contains, or is inside of an input.
std::string make_masks(const job::Job& job, Progress& progress);

}  // namespace dvi::commands
