#pragma once

#include "dvi/align/align.h"
#include "dvi/align/sight.h"

namespace dvi::align {

/// Aligns the views of one sequence jointly, against each other and against the nearest views of earlier sequences, whose poses
/// `out` has: fills the views' entries and adds the sequence's.
void align_jointly(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out);

}  // namespace dvi::align
