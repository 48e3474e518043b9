#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "dvi/drive/view.h"

namespace dvi {

/// The `most` views of [range.first, range.second) nearest to view `target`, nearest first and by number where they are as
/// near. A radian between the directions in which they look counts as much as `radian_m` meters between their places.
std::vector<std::size_t> nearest_views(const Views& views, std::size_t target, std::pair<std::size_t, std::size_t> range,
                                       std::size_t most, double radian_m = 0);

/// The views of the other cameras on the target's drive that were taken while its own `steps` views before and behind it were,
/// camera after camera.
std::vector<std::size_t> of_other_cameras(const Views& views, std::size_t target, std::size_t steps);

/// Of each sequence of another drive the `most` nearest views by place, sequence after sequence: time says nothing there.
std::vector<std::size_t> nearest_of_other_drives(const Views& views, std::size_t target, std::size_t most);

}  // namespace dvi
