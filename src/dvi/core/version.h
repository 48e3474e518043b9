#pragma once

namespace dvi {

inline constexpr const char* kVersion = "0.1.0";

}  // namespace dvi
