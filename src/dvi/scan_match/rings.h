#pragma once

#include <cstdint>
#include <vector>

#include "dvi/drive/scan.h"

namespace dvi::scan_match {

/// The points of a scan beam by beam, each in the order in which the beam turned.
struct Rings {
  enum class Source { file, order, elevation, none };
  Source source = Source::none;                    ///< none: the cloud shows no beams, `points` is empty
  std::vector<std::vector<std::uint32_t>> points;  ///< one list of indices a beam that returned anything
};

/// By the file's ring numbers, if these tell beams apart; else by turns, where the file holds one beam after the other; else by
/// elevation, where the elevations of all points fall into narrow groups.
Rings find_rings(const Scan& scan);

const char* to_string(Rings::Source source);

}  // namespace dvi::scan_match
