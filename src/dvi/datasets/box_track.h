#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dvi/drive/drive.h"

namespace dvi::datasets {

/// The boxes of one labeled object at key frames, in world axes. Annotators leave out key frames in which an object is
/// occluded.
struct BoxTrack {
  int number = -1;
  std::string type;
  std::map<std::int64_t, Box> boxes;  ///< by time [ns]; at least one

  /// The box at a time: linear between key frames, also across a gap that is_bridged(), and continued for 0.25 s beyond the
  /// ends.
  std::optional<Box> at(std::int64_t time_ns) const;

  /// Times without boxes, longer than one missing key frame (1.1 s).
  struct Gap {
    std::int64_t first_ns, last_ns;
    bool bridged;
  };
  std::vector<Gap> gaps() const;
};

/// Describes the gaps of tracks within a drive: how many are interpolated, and in which frames objects have no box. None if
/// there are no gaps.
std::optional<std::string> describe_gaps(const std::vector<BoxTrack>& tracks, const Drive& drive);

}  // namespace dvi::datasets
