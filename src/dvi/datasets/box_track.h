#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The boxes of one labeled object at key frames, in world axes. Key frames may be missing, since annotators skip those in
/// which an object is occluded.
struct BoxTrack {
  int number = -1;
  std::string type;
  std::map<std::int64_t, Box> boxes;  ///< by time [ns]; at least one

  /// Returns the box at a time: interpolated linearly between key frames, also across a bridged gap, and extrapolated for at
  /// most 0.25 s beyond the ends.
  std::optional<Box> at(std::int64_t time_ns) const;

  /// A period without boxes that is longer than one missing key frame (1.1 s).
  struct Gap {
    std::int64_t first_ns, last_ns;
    bool bridged;  ///< whether the object's motion across the gap is steady, so that at() interpolates it
  };
  /// Finds the gaps in order of time.
  std::vector<Gap> gaps() const;
};

/// Describes the gaps of tracks within a drive: how many are interpolated, and in which frames objects have no box. Returns
/// nothing if there are no gaps.
std::optional<std::string> describe_gaps(const std::vector<BoxTrack>& tracks, const Drive& drive);

}  // namespace dvi::datasets
