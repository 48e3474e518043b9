#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dvi/core/files.h"

namespace dvi {

/// Parse a finite number that takes up the whole text; return nothing otherwise.
std::optional<double> to_number(std::string_view text);
std::optional<int> to_integer(std::string_view text);
/// The latest time in seconds since 1970 (in 2096). It keeps the difference of any two times within 64 bits of nanoseconds,
/// including the clocks' offsets.
inline constexpr std::int64_t kLatestSecond = 4'000'000'000;
inline constexpr double kMaxOffsetS = 5e8;
/// Converts seconds to nanoseconds exactly, in decimal ("1534313591.432032") or scientific ("1.036224e-01") notation. Digits
/// after the ninth decimal are dropped.
std::optional<std::int64_t> to_nanoseconds(std::string_view seconds);
/// Converts nanoseconds to seconds.
inline double ns_to_s(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }
/// Formats nanoseconds as seconds: "1534313591.432032000".
std::string to_seconds(std::int64_t nanoseconds);
/// Converts KITTI's 'YYYY-MM-DD HH:MM:SS.nnnnnnnnn' to nanoseconds since 1970.
std::optional<std::int64_t> date_to_nanoseconds(std::string_view text);

/// The maximum size of a line of numbers. A longer line has other content, such as a whole file without line ends.
inline constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20;

bool is_all_digits(std::string_view text);
std::string to_lower_case(std::string text);
/// Splits a line at blanks.
std::vector<std::string> split_words(std::string_view line);
/// Splits a list at commas. Empty parts are kept: an empty text is one.
std::vector<std::string> split_at_commas(std::string_view list);
/// Formats numbers in order: "3, 177-180". Longer lists end in "and 12 more".
std::string format_ranges(const std::vector<int>& numbers);

/// One line of a text file, split at blanks. Throws InputError with file and line for missing or malformed words, and for a
/// line of more than kMaxLineBytes, whose words would take several times its size in memory.
class TextLine {
 public:
  TextLine(fs::path file, std::size_t number, std::string_view text);

  std::size_t size() const { return words_.size(); }
  const std::string& word(std::size_t i) const;
  double number(std::size_t i) const;
  int integer(std::size_t i) const;
  std::int64_t nanoseconds(std::size_t i) const;  ///< converts seconds like to_nanoseconds()
  /// Returns `N` numbers from word `first` to the end of the line.
  template <std::size_t N>
  std::array<double, N> numbers(std::size_t first) const {
    if (size() != first + N) fail("has " + std::to_string(size()) + " entries instead of " + std::to_string(first + N));
    std::array<double, N> out;
    for (std::size_t i = 0; i < N; ++i) out[i] = number(first + i);
    return out;
  }
  [[noreturn]] void fail(const std::string& problem, const std::string& remedy = {}) const;

 private:
  fs::path file_;
  std::size_t number_;
  std::vector<std::string> words_;
};

/// Reads all lines of a file, except those that begin with '#'.
std::vector<TextLine> read_text_lines(const fs::path& file);

}  // namespace dvi
