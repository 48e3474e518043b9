#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <iterator>

namespace dvi {

/// The item nearest to a time, of [begin, end) in order of their `time_ns`: of two as near the earlier, of several at one time
/// the first. `end` where there is none.
template <class Iterator>
Iterator nearest_in_time(Iterator begin, Iterator end, std::int64_t time_ns) {
  const auto from = [&](std::int64_t time) {
    return std::partition_point(begin, end, [&](const auto& item) { return item.time_ns < time; });
  };
  const Iterator after = from(time_ns);
  if (after == begin) return after;
  const Iterator before = std::prev(after);
  if (after != end && after->time_ns - time_ns < time_ns - before->time_ns) return after;
  return from(before->time_ns);
}

/// The same of a whole list, if it is no farther than that from the time; null otherwise.
template <class Items>
auto nearest_in_time(const Items& items, std::int64_t time_ns, std::int64_t within_ns) -> const typename Items::value_type* {
  const auto nearest = nearest_in_time(items.begin(), items.end(), time_ns);
  return nearest == items.end() || std::abs(nearest->time_ns - time_ns) > within_ns ? nullptr : &*nearest;
}

}  // namespace dvi
