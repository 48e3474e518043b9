#pragma once

#include <cstdint>

namespace dvi::objects {

/// Seconds that pass from one time to another; negative where `to` is the earlier one.
inline double seconds_from(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

}  // namespace dvi::objects
