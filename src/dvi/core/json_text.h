#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace dvi {

/// A document as text, indented by so many spaces; -1: in one line. Bytes that are not UTF-8, as in Latin-1 file names, become
/// U+FFFD; dump() would throw.
std::string json_text(const nlohmann::json& document, int indent = 1);

}  // namespace dvi
