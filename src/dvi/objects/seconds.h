#pragma once

#include <cstdint>

namespace dvi::objects {

/// Returns the seconds from one time to another, which are negative if `to_ns` is the earlier one.
inline double seconds_between(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

}  // namespace dvi::objects
