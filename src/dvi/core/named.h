#pragma once

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace dvi {

/// An enum whose values have names in options and reports. For each such enum E there is a function
///   constexpr auto names_of(E) { return std::array{std::pair{E::first, "first"}, ...}; }
template <class E>
concept Named = std::is_enum_v<E> && requires(E e) { names_of(e); };

/// Lists the names of an enum's values.
template <Named E>
std::vector<std::string> list_names() {
  std::vector<std::string> out;
  for (const auto& [value, name] : names_of(E{})) out.emplace_back(name);
  return out;
}

/// Returns the name of a value.
template <Named E>
std::string to_string(E value) {
  for (const auto& [known, name] : names_of(value))
    if (known == value) return name;
  throw std::logic_error("an enum value has no name");
}

/// Throws std::invalid_argument: must be one of these names.
[[noreturn]] void refuse_name(const std::vector<std::string>& names);

/// Returns the value of a name. Throws std::invalid_argument with the existing names if it is unknown.
template <Named E>
E parse_name(std::string_view text) {
  for (const auto& [value, name] : names_of(E{}))
    if (text == name) return value;
  refuse_name(list_names<E>());
}

}  // namespace dvi
