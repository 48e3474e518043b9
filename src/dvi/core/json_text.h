#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace dvi {

/// A document as text, indented by so many spaces; -1: in one line. Strings that are not UTF-8, as Latin-1 file names, are
/// encoded by to_toml_text(), which read_json() undoes; keys that are not get U+FFFD.
std::string json_text(const nlohmann::json& document, int indent = 1);

/// A whole number of a document within [least, most]. std::invalid_argument with `what` otherwise: the library would cut it.
std::int64_t whole_number(const nlohmann::json& value, const std::string& what, std::int64_t least, std::int64_t most);

}  // namespace dvi
