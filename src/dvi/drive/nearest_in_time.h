#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>

namespace dvi {

/// Finds the item nearest to a time in [begin, end), which is ordered by `time_of`, `time_ns` by default. Of two equally near
/// items it returns the earlier one, of equal times the first item, and `end` if there is no item.
template <class Iterator, class TimeOf = std::int64_t std::iterator_traits<Iterator>::value_type::*>
Iterator nearest_in_time(Iterator begin, Iterator end, std::int64_t time_ns,
                         TimeOf time_of = &std::iterator_traits<Iterator>::value_type::time_ns) {
  const auto from = [&](std::int64_t time) {
    return std::partition_point(begin, end, [&](const auto& item) { return std::invoke(time_of, item) < time; });
  };
  const Iterator after = from(time_ns);
  if (after == begin) return after;
  const Iterator before = std::prev(after);
  if (after != end && std::invoke(time_of, *after) - time_ns < time_ns - std::invoke(time_of, *before)) return after;
  return from(std::invoke(time_of, *before));
}

/// The time within which an image and a scan show the same moment: the period of a LiDAR at 10 Hz.
inline constexpr std::int64_t kMaxFrameToScanNs = 100'000'000;

/// Does the same for a list; returns null if the item is farther than `within_ns` from the time.
template <class Items>
auto nearest_in_time(const Items& items, std::int64_t time_ns, std::int64_t within_ns) -> const typename Items::value_type* {
  const auto nearest = nearest_in_time(items.begin(), items.end(), time_ns);
  return nearest == items.end() || std::abs(nearest->time_ns - time_ns) > within_ns ? nullptr : &*nearest;
}

}  // namespace dvi
