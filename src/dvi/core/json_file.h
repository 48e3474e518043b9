#pragma once

#include <nlohmann/json_fwd.hpp>

#include "dvi/core/files.h"

namespace dvi {

/// What becomes of a file that holds no JSON.
enum class DamagedJson { throws, is_discarded };

/// Reads a JSON document that json_text() wrote, with strings that are not UTF-8 as they were. Throws InputError as read_file()
/// does. If the document is malformed, throws nlohmann::json::parse_error, or returns a discarded value.
nlohmann::json read_json(const fs::path& file, DamagedJson damaged = DamagedJson::throws);

}  // namespace dvi
