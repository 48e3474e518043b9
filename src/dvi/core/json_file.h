#pragma once

#include <nlohmann/json_fwd.hpp>

#include "dvi/core/files.h"

namespace dvi {

/// The handling of a file that is not JSON.
enum class DamagedJson { throws, is_discarded };

/// Reads a JSON document of json_text() and restores strings that are not UTF-8. Throws InputError like read_file(). If the
/// document is malformed, throws nlohmann::json::parse_error or returns a discarded value.
nlohmann::json read_json(const fs::path& file, DamagedJson damaged = DamagedJson::throws);

}  // namespace dvi
