#include "dvi/core/text.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "dvi/core/error.h"

namespace dvi {
namespace {

template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// No program prints more digits of a double.
constexpr int kMaxTimeDigits = 400;

// Computes the digits times 10^shift, rounded down; returns nothing beyond kLatestSecond.
std::optional<std::int64_t> to_whole_nanoseconds(std::string digits, int shift) {
  if (shift >= 0)
    digits.append(static_cast<std::size_t>(shift), '0');
  else
    digits.resize(digits.size() - std::min(digits.size(), static_cast<std::size_t>(-shift)));
  const std::size_t first = std::min(digits.find_first_not_of('0'), digits.size());
  if (first == digits.size()) return 0;
  const auto ns = parse_whole<std::int64_t>(std::string_view(digits).substr(first));
  return ns && *ns < (kLatestSecond + 1) * 1'000'000'000 ? ns : std::nullopt;
}

}  // namespace

std::optional<double> to_number(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int> to_integer(std::string_view text) { return parse_whole<int>(text); }

std::optional<std::int64_t> to_nanoseconds(std::string_view seconds) {
  const bool negative = seconds.starts_with('-');
  if (negative || seconds.starts_with('+')) seconds.remove_prefix(1);
  const std::size_t mantissa_end = std::min(seconds.find_first_of("eE"), seconds.size());
  int exponent = 0;
  if (mantissa_end < seconds.size()) {
    const std::optional<int> given = to_integer(seconds.substr(mantissa_end + 1));
    if (!given) return std::nullopt;
    exponent = std::clamp(*given, -kMaxTimeDigits, kMaxTimeDigits);
  }
  const std::string_view mantissa = seconds.substr(0, mantissa_end);
  const std::size_t dot = std::min(mantissa.find('.'), mantissa.size());
  const std::string_view fraction = mantissa.substr(std::min(dot + 1, mantissa.size()));
  const std::string digits = std::string(mantissa.substr(0, dot)) + std::string(fraction);
  if (!is_all_digits(digits) || digits.size() > kMaxTimeDigits) return std::nullopt;
  const auto ns = to_whole_nanoseconds(digits, 9 + exponent - static_cast<int>(fraction.size()));
  return ns && negative ? -*ns : ns;
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
  constexpr std::int64_t kMaxMinuteNs = 61'000'000'000;  // with a leap second
  const bool in_day = *hour >= 0 && *hour < 24 && *minute >= 0 && *minute < 60 && *ns >= 0 && *ns < kMaxMinuteNs;
  using namespace std::chrono;
  const year_month_day date(std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                            std::chrono::day(static_cast<unsigned>(*day)));
  if (!in_day || !date.ok() || *year < 1970) return std::nullopt;
  const auto whole = sys_days(date).time_since_epoch() + hours(*hour) + minutes(*minute);
  if (whole >= seconds(kLatestSecond)) return std::nullopt;
  return duration_cast<nanoseconds>(whole).count() + *ns;
}

bool is_all_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::string to_lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::vector<std::string> split_at_commas(std::string_view list) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    parts.emplace_back(list.substr(at, end - at));
    at = end + 1;
  }
  return parts;
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

std::string format_ranges(const std::vector<int>& numbers) {
  constexpr int kMaxRanges = 12;
  std::string text;
  int parts = 0;
  for (std::size_t i = 0; i < numbers.size(); ++parts) {
    if (parts == kMaxRanges) return text + " and " + std::to_string(numbers.size() - i) + " more";
    std::size_t last = i;
    while (last + 1 < numbers.size() && numbers[last + 1] == numbers[last] + 1) ++last;
    text += (parts ? ", " : "") + std::to_string(numbers[i]);
    if (last > i) text += "-" + std::to_string(numbers[last]);
    i = last + 1;
  }
  return text;
}

TextLine::TextLine(fs::path file, std::size_t number, std::string_view text) : file_(std::move(file)), number_(number) {
  if (text.size() > kMaxLineBytes)
    throw InputError(
        file_.string() + ":" + std::to_string(number_), fmt::format("the line has {} bytes", text.size()),
        fmt::format("at most {} are supported; the file may be of another kind or without line ends", kMaxLineBytes));
  words_ = split_words(text);
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
  constexpr std::size_t kNanosecondDigits = 19;  // digits of a time since 1970
  std::optional<std::int64_t> counted_ns;
  if (is_all_digits(word(i)) && word(i).size() == kNanosecondDigits) counted_ns = parse_whole<std::int64_t>(word(i));
  fail("'" + word(i) + "' is not a time in seconds",
       counted_ns ? "it is in nanoseconds; write seconds, such as " + to_seconds(*counted_ns)
                  : "a time is a number such as 1534313591.432032 or 1.036224e-01");
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

}  // namespace dvi
