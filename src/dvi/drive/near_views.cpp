#include "dvi/drive/near_views.h"

#include <algorithm>
#include <ranges>

namespace dvi {
namespace {

constexpr std::int64_t kAloneNs = 50'000'000;  // around a frame without neighbors; half of a usual period

}  // namespace

std::vector<std::size_t> find_nearest_views(const Views& views, std::size_t target, std::pair<std::size_t, std::size_t> range,
                                            const ViewSearch& search) {
  const SE3 here = views[target].camera_from_world.inverse();
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = range.first; i < range.second; ++i) {
    const SE3 there = views[i].camera_from_world.inverse();
    near.emplace_back((there.t - here.t).norm() + search.radian_m * (there.R.col(2) - here.R.col(2)).norm(), i);
  }
  const std::size_t most = std::min(search.max_views, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(most), near.end());
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < most; ++k) out.push_back(near[k].second);
  return out;
}

std::vector<std::size_t> list_views_of_other_cameras(const Views& views, std::size_t target, std::size_t steps) {
  const auto [first, last] = views.of_sequence(views[target].sequence);
  // Half a period is added because the cameras of a rig may be triggered at different times.
  const auto time = [&views](std::size_t i) { return views[i].time_ns; };
  const std::size_t before = target - std::min(steps, target - first), behind = std::min(last - 1, target + steps);
  const std::int64_t half = last - first > 1
                                ? (time(last - 1) - time(first)) / static_cast<std::int64_t>(2 * (last - first - 1))
                                : std::int64_t{kAloneNs};
  std::vector<std::size_t> out;
  for (int sequence = 0; sequence < views.sequences(); ++sequence) {
    const auto [begin, end] = views.of_sequence(sequence);
    if (begin == end || begin == first || views[begin].drive != views[target].drive) continue;
    const auto all = std::views::iota(begin, end);
    const auto early = [&](std::size_t i) { return time(i) < time(before) - half; };
    const auto not_late = [&](std::size_t i) { return time(i) <= time(behind) + half; };
    const std::size_t to = *std::ranges::partition_point(all, not_late);
    for (std::size_t i = *std::ranges::partition_point(all, early); i < to; ++i) out.push_back(i);
  }
  return out;
}

std::vector<std::size_t> find_nearest_views_of_other_drives(const Views& views, std::size_t target, std::size_t most) {
  std::vector<std::size_t> out;
  for (int sequence = 0; sequence < views.sequences(); ++sequence) {
    const auto range = views.of_sequence(sequence);
    if (range.first == range.second || views[range.first].drive == views[target].drive) continue;
    for (const std::size_t view : find_nearest_views(views, target, range, {most})) out.push_back(view);
  }
  return out;
}

}  // namespace dvi
