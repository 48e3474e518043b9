#pragma once

#include "dvi/align/align.h"
#include "dvi/align/unmasked_points.h"

namespace dvi::align {

/// Runs the published search on the views of one sequence, each relative to its two neighbors with their given poses: finds the
/// pitch and yaw that minimize eq. 1, E = sum |c(p) - c(q)|^2 over the map points p in the ring around the mask, where c(q) is
/// the color in a neighbor. Tries ten steps of 0.001 rad to each side, then ten of 0.0001 rad. Fills the sequence's entries of
/// `out`.
void search_as_published(const SequenceViews& sequence, const AlignOptions& options, const Tick& tick, Cameras& out);

}  // namespace dvi::align
