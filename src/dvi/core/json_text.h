#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace dvi {

/// A document as text, indented by one. Bytes that are not UTF-8, as in Latin-1 file names, become U+FFFD; dump() would throw.
std::string json_text(const nlohmann::json& document);

}  // namespace dvi
