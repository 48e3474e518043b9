#include "dvi/core/natural_order.h"

#include <algorithm>
#include <cstddef>

namespace dvi {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

std::string_view find_digits(std::string_view text, std::size_t begin) {
  std::size_t end = begin;
  while (end < text.size() && is_digit(text[end])) ++end;
  return text.substr(begin, end - begin);
}

int compare_values(std::string_view a, std::string_view b) {
  a.remove_prefix(std::min(a.find_first_not_of('0'), a.size()));
  b.remove_prefix(std::min(b.find_first_not_of('0'), b.size()));
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

bool is_decimal(std::string_view text, std::size_t begin) {
  return begin >= 2 && text[begin - 1] == '.' && is_digit(text[begin - 2]);
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    const std::string_view digits_a = find_digits(a, i), digits_b = find_digits(b, j);
    const int order = is_decimal(a, i) ? digits_a.compare(digits_b) : compare_values(digits_a, digits_b);
    if (order != 0) return order < 0;
    i += digits_a.size(), j += digits_b.size();
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;
}

}  // namespace dvi
