#pragma once

#include "dvi/core/files.h"

namespace toml {
inline namespace v3 {
class table;  // NOLINT(readability-identifier-naming): the name of the library
}
}  // namespace toml

namespace dvi {

/// Reads and parses a file of settings. Throws InputError like read_settings(), and if it is malformed, with the line number if
/// that is known.
toml::table read_toml(const fs::path& path);

}  // namespace dvi
