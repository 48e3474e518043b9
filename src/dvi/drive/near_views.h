#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "dvi/drive/view.h"

namespace dvi {

/// The number of nearest views, and the measure of their distance.
struct ViewSearch {
  std::size_t max_views = 0;
  /// The distance in meters that counts like an angle of one radian between the viewing directions.
  double radian_m = 0;
};

/// Finds the views of [range.first, range.second) nearest to view `target`, ordered by distance and then by number.
std::vector<std::size_t> find_nearest_views(const Views& views, std::size_t target, std::pair<std::size_t, std::size_t> range,
                                            const ViewSearch& search);

/// Lists the views of the other cameras on the target's drive that were taken during the time of its own `steps` views before
/// and after it, camera by camera.
std::vector<std::size_t> list_views_of_other_cameras(const Views& views, std::size_t target, std::size_t steps);

/// Finds the `most` nearest views by position of each sequence of another drive, sequence by sequence. The times of other
/// drives are ignored.
std::vector<std::size_t> find_nearest_views_of_other_drives(const Views& views, std::size_t target, std::size_t most);

}  // namespace dvi
