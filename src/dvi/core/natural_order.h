#pragma once

#include <string_view>

namespace dvi {

/// Orders names by the numbers in them: "frame2" comes before "frame10". Runs of digits compare by value; behind digits and a
/// point they are decimals, so that "7.25" comes before "7.5". Names that differ only in leading zeros compare byte by byte,
/// and so do all others.
bool natural_less(std::string_view a, std::string_view b);

/// The same order for std::set and std::map.
struct NaturalLess {
  bool operator()(std::string_view a, std::string_view b) const { return natural_less(a, b); }
};

}  // namespace dvi
