#pragma once

#include "dvi/align/align.h"
#include "dvi/align/sight.h"

namespace dvi::align {

/// The published search on the views of one drive, each against its two neighbors as given: the pitch and yaw that
/// minimize eq. 1, E = sum |c(p) - c(q)|^2 over the map points p in the ring round the mask, c(q) what a neighbor shows there;
/// ten steps of 0.001 rad to each side, then ten of 0.0001. Fills the drive's entries of `out`.
void search_as_published(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out);

}  // namespace dvi::align
