#pragma once

#include <string_view>

namespace dvi {

/// Orders names by the numbers in them: "frame2" comes before "frame10". Runs of digits are compared by value; after digits and
/// a point they are decimals, so that "7.25" comes before "7.5". All other characters, and names that differ only in leading
/// zeros, are compared by byte.
bool natural_less(std::string_view a, std::string_view b);

/// The same order for std::set and std::map.
struct NaturalLess {
  bool operator()(std::string_view a, std::string_view b) const { return natural_less(a, b); }
};

}  // namespace dvi
