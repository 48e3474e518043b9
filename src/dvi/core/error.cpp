#include "dvi/core/error.h"

#include <fmt/format.h>

namespace dvi {

InputError::InputError(const std::filesystem::path& path, const std::string& problem, const std::string& remedy)
    : std::runtime_error(path.string() + ": " + problem + (remedy.empty() ? "" : "; " + remedy)) {}

std::string to_printable(std::string_view message) {
  constexpr std::size_t kMaxBytes = 3000;  // a word of a file may have a gigabyte
  std::string out;
  for (const char c : message) {
    if (out.size() >= kMaxBytes) return out + fmt::format(" ... ({} bytes in all)", message.size());
    const auto byte = static_cast<unsigned char>(c);
    if ((byte >= 0x20 && byte != 0x7F) || c == '\n')
      out += c;
    else
      out += fmt::format("\\x{:02x}", byte);
  }
  return out;
}

}  // namespace dvi
