#include "dvi/core/json_file.h"

#include <nlohmann/json.hpp>

#include "dvi/core/toml_text.h"

namespace dvi {
namespace {

void decode_strings(nlohmann::json& value) {
  if (value.is_string()) value = from_toml_text(value.get_ref<const std::string&>());
  if (value.is_structured())
    for (nlohmann::json& item : value) decode_strings(item);
}

}  // namespace

nlohmann::json read_json(const fs::path& file, DamagedJson damaged) {
  nlohmann::json document = nlohmann::json::parse(read_file(file), nullptr, damaged == DamagedJson::throws);
  decode_strings(document);
  return document;
}

}  // namespace dvi
