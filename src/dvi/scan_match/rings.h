#pragma once

#include <cstdint>
#include <vector>

#include "dvi/drive/scan.h"

namespace dvi::scan_match {

/// The points of a scan by beam, in the order of the beam's rotation.
struct Rings {
  enum class Source { file, order, elevation, none };
  Source source = Source::none;                    ///< none: no beams were found, and `points` is empty
  std::vector<std::vector<std::uint32_t>> points;  ///< the indices of points per beam with returns
};

/// Finds the beams by the file's ring numbers if these distinguish beams; otherwise by revolutions if the file has one beam
/// after the other; otherwise by elevation if the elevations form narrow groups.
Rings find_rings(const Scan& scan);

const char* to_string(Rings::Source source);

}  // namespace dvi::scan_match
