#include "dvi/core/toml_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include "dvi/core/error.h"

namespace dvi {

toml::table read_toml(const fs::path& path) {
  const std::string text = read_settings(path);
  try {
    return toml::parse(text);
  } catch (const toml::parse_error& e) {
    throw InputError(fmt::format("{}:{}", path.string(), e.source().begin.line), std::string(e.description()));
  } catch (const std::runtime_error&) {  // TOML_ASSERT, for which the library has no line number
    throw InputError(path, "is malformed TOML", "check that a name follows each '['");
  }
}

}  // namespace dvi
