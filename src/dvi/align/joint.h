#pragma once

#include "dvi/align/align.h"
#include "dvi/align/sight.h"

namespace dvi::align {

/// Aligns the views of one sequence jointly: fills their entries of `out` and adds the sequence's.
void align_jointly(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out);

}  // namespace dvi::align
