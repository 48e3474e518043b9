#include "dvi/io/text.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi::io {
namespace {

template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

std::optional<double> to_number(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int> to_integer(std::string_view text) { return parse_whole<int>(text); }

std::optional<std::int64_t> to_nanoseconds(std::string_view seconds) {
  const bool negative = seconds.starts_with('-');
  if (negative) seconds.remove_prefix(1);
  const std::size_t dot = seconds.find('.');
  const std::string_view whole = seconds.substr(0, dot);
  std::string fraction(dot == std::string_view::npos ? "" : seconds.substr(dot + 1));
  if (whole.empty() || whole.size() > 10 || !all_digits(whole)) return std::nullopt;
  if (!fraction.empty() && !all_digits(fraction)) return std::nullopt;
  const std::int64_t whole_seconds = *parse_whole<std::int64_t>(whole);
  if (whole_seconds > kLatestSecond) return std::nullopt;
  fraction.resize(9, '0');
  const std::int64_t ns = whole_seconds * 1'000'000'000 + *parse_whole<std::int64_t>(fraction);
  return negative ? -ns : ns;
}

std::string to_seconds(std::int64_t nanoseconds) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  return fmt::format("{}{}.{:09}", nanoseconds < 0 ? "-" : "", std::abs(nanoseconds / kSecond),
                     std::abs(nanoseconds % kSecond));
}

std::optional<std::int64_t> date_to_nanoseconds(std::string_view text) {
  if (text.size() < 19 || text[4] != '-' || text[7] != '-' || text[10] != ' ' || text[13] != ':' || text[16] != ':')
    return std::nullopt;
  const auto year = to_integer(text.substr(0, 4)), month = to_integer(text.substr(5, 2)), day = to_integer(text.substr(8, 2));
  const auto hour = to_integer(text.substr(11, 2)), minute = to_integer(text.substr(14, 2));
  const auto ns = to_nanoseconds(text.substr(17));
  if (!year || !month || !day || !hour || !minute || !ns) return std::nullopt;
  constexpr std::int64_t kLongestMinute = 61'000'000'000;  // with a leap second
  const bool in_day = *hour >= 0 && *hour < 24 && *minute >= 0 && *minute < 60 && *ns >= 0 && *ns < kLongestMinute;
  using namespace std::chrono;
  const year_month_day date(std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                            std::chrono::day(static_cast<unsigned>(*day)));
  if (!in_day || !date.ok() || *year < 1970) return std::nullopt;
  const auto whole = sys_days(date).time_since_epoch() + hours(*hour) + minutes(*minute);
  if (whole >= seconds(kLatestSecond)) return std::nullopt;
  return duration_cast<nanoseconds>(whole).count() + *ns;
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::vector<std::string> split_words(std::string_view line) {
  constexpr std::string_view kBlanks = " \t\r";
  std::vector<std::string> words;
  for (std::size_t at = line.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(kBlanks, at), line.size());
    words.emplace_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlanks, end);
  }
  return words;
}

std::string ranges(const std::vector<int>& numbers) {
  constexpr int kLongest = 12;
  std::string text;
  int parts = 0;
  for (std::size_t i = 0; i < numbers.size(); ++parts) {
    if (parts == kLongest) return text + " and " + std::to_string(numbers.size() - i) + " more";
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += (parts ? ", " : "") + std::to_string(numbers[i]);
    if (last > i) text += "-" + std::to_string(numbers[last]);
    i = last + 1;
  }
  return text;
}

const std::string& TextLine::word(std::size_t i) const {
  if (words_.empty()) fail("is empty");
  if (i >= size()) fail("has only " + std::to_string(size()) + " entries");
  return words_[i];
}

double TextLine::number(std::size_t i) const {
  if (const auto value = to_number(word(i))) return *value;
  fail("'" + word(i) + "' is not a number");
}

int TextLine::integer(std::size_t i) const {
  if (const auto value = to_integer(word(i))) return *value;
  fail("'" + word(i) + "' is not a whole number");
}

std::int64_t TextLine::nanoseconds(std::size_t i) const {
  if (const auto value = to_nanoseconds(word(i))) return *value;
  fail("'" + word(i) + "' is not a time in decimal seconds");
}

void TextLine::fail(const std::string& problem, const std::string& remedy) const {
  throw InputError(file_.string() + ":" + std::to_string(number_), words_.empty() ? "the line is empty" : problem, remedy);
}

std::vector<TextLine> read_text_lines(const fs::path& file) {
  std::vector<TextLine> lines;
  std::size_t number = 0;
  for (const std::string& text : read_lines(file))
    if (++number; !text.starts_with('#')) lines.emplace_back(file, number, text);
  return lines;
}

}  // namespace dvi::io
