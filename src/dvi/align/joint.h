#pragma once

#include "dvi/align/align.h"

namespace dvi::align {

/// Aligns the views [first, last) of one drive jointly: fills their entries of `out`, adds the drive's and warnings.
void align_jointly(const Views& views, const map::StaticMap& map, std::size_t first, std::size_t last,
                   const AlignOptions& options, const Tick& tick, Cameras& out);

}  // namespace dvi::align
