#pragma once

#include <string>
#include <string_view>

namespace dvi {

/// Whether bytes are UTF-8, as TOML and JSON require.
bool is_utf8(std::string_view bytes);

/// Encodes a string for TOML or JSON, which hold UTF-8 only: file names can hold any byte. A string that is not UTF-8 becomes
/// "file:" with its special bytes as %XX, as in a URI; all others stay as they are.
std::string to_toml_text(const std::string& bytes);

/// Decodes what to_toml_text() wrote, and "file:///path" as other programs write it.
std::string from_toml_text(const std::string& text);

}  // namespace dvi
