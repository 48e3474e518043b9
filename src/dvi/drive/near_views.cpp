#include "dvi/drive/near_views.h"

#include <algorithm>

namespace dvi {

std::vector<std::size_t> nearest_views(const Views& views, std::size_t target, std::pair<std::size_t, std::size_t> range,
                                       std::size_t most, double radian_m) {
  const SE3 here = views[target].camera_from_world.inverse();
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = range.first; i < range.second; ++i) {
    const SE3 there = views[i].camera_from_world.inverse();
    near.emplace_back((there.t - here.t).norm() + radian_m * (there.R.col(2) - here.R.col(2)).norm(), i);
  }
  most = std::min(most, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(most), near.end());
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < most; ++k) out.push_back(near[k].second);
  return out;
}

std::vector<std::size_t> nearest_of_other_drives(const Views& views, std::size_t target, std::size_t most) {
  std::vector<std::size_t> out;
  for (int drive = 0; drive < views.drives(); ++drive) {
    if (drive == views[target].drive) continue;
    for (const std::size_t view : nearest_views(views, target, views.of_drive(drive), most)) out.push_back(view);
  }
  return out;
}

}  // namespace dvi
