#pragma once

#include <string>
#include <string_view>

namespace dvi {

/// Returns whether bytes are UTF-8, as TOML and JSON require.
bool is_utf8(std::string_view bytes);

/// Encodes a string for TOML or JSON, which are limited to UTF-8, because file names can hold any byte. A string that is not
/// UTF-8 becomes "file:" with its special bytes as %XX, as in a URI; all others are unchanged.
std::string to_toml_text(const std::string& bytes);

/// Decodes strings of to_toml_text(), and "file:///path" of other programs.
std::string from_toml_text(const std::string& text);

}  // namespace dvi
