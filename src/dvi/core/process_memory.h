#pragma once

#include <cstddef>

namespace dvi {

/// Returns the bytes of physical memory that the process occupies now, with its libraries; 0 if it is unknown.
std::size_t resident_memory();

/// Returns the most that it has occupied so far.
std::size_t peak_memory();

}  // namespace dvi
