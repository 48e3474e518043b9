#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>

namespace dvi {

/// The item nearest to a time, of [begin, end) in order of their `time_of`, by default their `time_ns`: of two as near the
/// earlier, of several at one time the first. `end` where there is none.
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

/// The same of a whole list, if it is no farther than that from the time; null otherwise.
template <class Items>
auto nearest_in_time(const Items& items, std::int64_t time_ns, std::int64_t within_ns) -> const typename Items::value_type* {
  const auto nearest = nearest_in_time(items.begin(), items.end(), time_ns);
  return nearest == items.end() || std::abs(nearest->time_ns - time_ns) > within_ns ? nullptr : &*nearest;
}

}  // namespace dvi
