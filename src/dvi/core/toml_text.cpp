#include "dvi/core/toml_text.h"

#include <charconv>
#include <cstddef>

#include <fmt/format.h>

namespace dvi {
namespace {

constexpr std::string_view kScheme = "file:";

// Returns the length of the UTF-8 character at the beginning of a text; 0 if there is none.
std::size_t find_character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
  const bool beyond = (first == 0xED && byte(1) > 0x9F) || (first == 0xF4 && byte(1) > 0x8F);  // surrogates, or above U+10FFFF
  return overlong || beyond ? 0 : length;
}

}  // namespace

bool is_utf8(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t length = find_character_length(bytes);
    if (length == 0) return false;
    bytes.remove_prefix(length);
  }
  return true;
}

std::string to_toml_text(const std::string& bytes) {
  if (is_utf8(bytes)) return bytes;
  std::string text(kScheme);
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= 0x20 || byte >= 0x7F || c == '%')
      text += fmt::format("%{:02X}", byte);
    else
      text += c;
  }
  return text;
}

std::string from_toml_text(const std::string& text) {
  if (!text.starts_with(kScheme)) return text;
  std::string_view rest = std::string_view(text).substr(kScheme.size());
  if (rest.starts_with("///")) rest.remove_prefix(2);
  std::string bytes;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    unsigned value = 0;
    const bool coded = rest[i] == '%' && i + 2 < rest.size() &&
                       std::from_chars(rest.data() + i + 1, rest.data() + i + 3, value, 16).ptr == rest.data() + i + 3;
    bytes += coded ? static_cast<char>(value) : rest[i];
    if (coded) i += 2;
  }
  return bytes;
}

}  // namespace dvi
