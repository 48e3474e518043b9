#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "dvi/core/named.h"

namespace dvi {

/// A source of masks. files: mask files. labels: labels of the drive and label files. detected: a network that detects objects
/// in the images. points: labels of the returns in the scans. found: motion segmentation in scans and images. reprojected: the
/// masks of the rig's first camera (objects/reprojected_mask.h).
enum class MaskSource : std::uint8_t { files, labels, detected, points, found, reprojected };
constexpr auto names_of(MaskSource) {
  return std::array{std::pair{MaskSource::files, "files"},       std::pair{MaskSource::labels, "labels"},
                    std::pair{MaskSource::detected, "detector"}, std::pair{MaskSource::points, "points"},
                    std::pair{MaskSource::found, "found"},       std::pair{MaskSource::reprojected, "reprojected"}};
}

/// Returns whether a source shows objects in scans.
constexpr bool is_of_scans(MaskSource source) { return source == MaskSource::points || source == MaskSource::found; }

/// The sources whose union is removed from the images of a camera.
using MaskSources = std::set<MaskSource>;

/// Lists the names of sources, such as "files, found"; "none" if there are none.
inline std::string to_string(const MaskSources& sources) {
  std::string out;
  for (const MaskSource source : sources) out += (out.empty() ? "" : ", ") + to_string(source);
  return out.empty() ? "none" : out;
}

}  // namespace dvi
