#pragma once

#include <string>

#include "dvi/core/files.h"

namespace dvi {

/// Reads a text file without its byte order mark. Throws InputError like read_file(), and if the text is UTF-16.
std::string read_text(const fs::path& path, std::uintmax_t most = kMaxFileBytes);

}  // namespace dvi
