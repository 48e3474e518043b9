#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace dvi {

/// Formats a document with an indentation; -1 means one line. Strings that are not UTF-8, such as Latin-1 file names, are
/// encoded by to_toml_text() and restored by read_json(). Invalid bytes in keys become U+FFFD.
std::string json_text(const nlohmann::json& document, int indent = 1);

/// Returns a whole number of a document within [least, most]. Throws std::invalid_argument with `what` otherwise; the library
/// would truncate the value.
std::int64_t to_whole_number(const nlohmann::json& value, const std::string& what, std::int64_t least, std::int64_t most);

}  // namespace dvi
