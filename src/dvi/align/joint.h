#pragma once

#include "dvi/align/align.h"
#include "dvi/align/sight.h"

namespace dvi::align {

/// Aligns the views of one drive jointly: fills their entries of `out`, adds the drive's and warnings.
void align_jointly(const DriveViews& drive, const AlignOptions& options, const Tick& tick, Cameras& out);

}  // namespace dvi::align
