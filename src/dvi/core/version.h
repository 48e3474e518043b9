#pragma once

namespace dvi {

inline constexpr const char* kVersion = "0.2.0";

}  // namespace dvi
