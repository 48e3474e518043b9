#pragma once

#include "dvi/align/align.h"

namespace dvi::align {

/// Aligns the views [first, last) of one drive jointly: changes their poses, fills their entries of `out.views` and adds the
/// drive's to `out.drives`, and warnings.
void align_jointly(Views& views, const map::StaticMap& map, std::size_t first, std::size_t last, const AlignOptions& options,
                   const Tick& tick, Alignment& out);

}  // namespace dvi::align
