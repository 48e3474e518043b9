#include "dvi/core/json_text.h"

#include <nlohmann/json.hpp>

namespace dvi {

std::string json_text(const nlohmann::json& document, int indent) {
  return document.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace dvi
