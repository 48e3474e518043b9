#pragma once

#include "dvi/core/files.h"

namespace toml {
inline namespace v3 {
class table;
}
}  // namespace toml

namespace dvi {

/// A file of settings, parsed. InputError as read_settings(), and where it is malformed, with its line where that is known.
toml::table read_toml(const fs::path& path);

}  // namespace dvi
