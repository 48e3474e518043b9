#include "dvi/core/json_text.h"

#include <stdexcept>

#include <nlohmann/json.hpp>

#include "dvi/core/toml_text.h"

namespace dvi {

namespace {

void encode_strings(nlohmann::json& value) {
  if (value.is_string()) value = to_toml_text(value.get_ref<const std::string&>());
  if (value.is_structured())
    for (nlohmann::json& item : value) encode_strings(item);
}

}  // namespace

std::string json_text(const nlohmann::json& document, int indent) {
  try {
    return document.dump(indent);
  } catch (const nlohmann::json::type_error&) {  // a string is not UTF-8
    nlohmann::json encoded = document;
    encode_strings(encoded);
    return encoded.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
  }
}

std::int64_t to_whole_number(const nlohmann::json& value, const std::string& what, std::int64_t least, std::int64_t most) {
  const bool fits = value.is_number_unsigned() ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX)
                                               : value.is_number_integer();
  if (fits)
    if (const auto number = value.get<std::int64_t>(); number >= least && number <= most) return number;
  throw std::invalid_argument(what + " is not a whole number from " + std::to_string(least) + " to " + std::to_string(most));
}

}  // namespace dvi
