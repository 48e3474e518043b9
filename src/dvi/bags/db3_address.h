#pragma once

#include <string>

#include "dvi/core/files.h"

namespace dvi::bags {

/// Returns the address by which SQLite opens a database for reading without writing files beside it. If a killed recorder left
/// messages in a write-ahead log, they are read as well, which requires SQLite to write an index.
std::string make_database_address(const fs::path& path);

}  // namespace dvi::bags
