#pragma once

#include "dvi/core/files.h"

namespace dvi {

/// Returns whether a path is a folder or inside of it, with links resolved. Neither needs to exist.
bool is_inside(const fs::path& path, const fs::path& folder);

}  // namespace dvi
