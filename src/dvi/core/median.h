#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace dvi {

/// Returns the median of values, the upper one of an even number; zero if there are none.
template <class T>
T median(std::vector<T> values) {
  if (values.empty()) return T{};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace dvi
