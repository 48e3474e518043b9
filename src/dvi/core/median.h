#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace dvi {

/// The value in the middle, of an even number the upper one; zero of none.
template <class T>
T median(std::vector<T> values) {
  if (values.empty()) return T{};
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace dvi
