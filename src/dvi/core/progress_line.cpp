#include "dvi/core/progress_line.h"

#include <algorithm>

#include <fmt/format.h>

namespace dvi {
namespace {

std::string format_count(const StageProgress& at, const char* of) {
  return at.total > 0 ? fmt::format("{}{}{}", at.done, of, at.total) : fmt::format("{}", at.done);
}

std::string format_time(const StageProgress& at, bool ended) {
  if (ended) return format_duration(at.seconds);
  const std::optional<double> left = at.of_run ? at.of_run->seconds_left : at.seconds_left();
  return left ? format_duration(*left) + " left" : "";
}

/// Returns the name of a stage after its number in the run.
std::string format_name(const StageProgress& at) {
  return at.of_run && at.of_run->number > 0 ? fmt::format("{}/{} {}", at.of_run->number, at.of_run->count, at.stage) : at.stage;
}

std::string join(const std::string& line, const char* separator, const std::string& part) {
  return part.empty() ? line : line + separator + part;
}

}  // namespace

std::optional<double> StageProgress::seconds_left() const {
  const bool known = seconds >= 1 && (done >= 3 || seconds >= 5) && done > 0 && 50 * done >= total;
  if (!known || total <= done) return std::nullopt;
  return seconds * static_cast<double>(total - done) / static_cast<double>(done);
}

std::string StageProgress::rate() const {
  if (done == 0 || seconds <= 0) return "";
  const double each = seconds / static_cast<double>(done);
  return each > 1 ? fmt::format("{:.1f} s each", each) : fmt::format("{:.1f}/s", 1 / each);
}

std::string format_duration(double seconds) {
  const auto s = static_cast<long long>(seconds + 0.5);
  if (s < 60) return fmt::format("{} s", s);
  return s < 3600 ? fmt::format("{}:{:02} min", s / 60, s % 60) : fmt::format("{}:{:02} h", s / 3600, s / 60 % 60);
}

std::string format_bar_line(const StageProgress& at, bool ended, std::size_t columns) {
  constexpr std::size_t kMaxBarWidth = 30, kMinBarWidth = 8;
  const std::string name = fmt::format("{:<10}", format_name(at)), left = format_time(at, ended);
  const std::string counted = at.total > 0 || at.done > 0 ? format_count(at, "/") : "";
  const auto fits = [&](const std::string& line) { return line.size() < columns; };
  const auto line = [&](const std::string& bar, const std::string& rate) {
    return join(join(join(join(name, " ", bar), " ", counted), "  ", rate), "  ", left);
  };
  const auto barred = [&](const std::string& rate) -> std::optional<std::string> {
    const std::size_t others = line("[]", rate).size() + 1;
    if (at.total == 0 || at.done == 0 || others + kMinBarWidth > columns) return std::nullopt;
    const std::size_t width = std::min(kMaxBarWidth, columns - others), full = std::min(width, width * at.done / at.total);
    return line(fmt::format("[{:#<{}}{:.<{}}]", "", full, "", width - full), rate);
  };
  for (const std::string& rate : {at.rate(), std::string()})
    if (const std::optional<std::string> whole = barred(rate)) return *whole;
  for (const std::string& text : {line("", ""), join(name, " ", counted)})
    if (fits(text)) return text;
  return format_name(at).substr(0, columns > 0 ? columns - 1 : 0);
}

std::string format_log_line(const StageProgress& at, bool ended) {
  if (ended) return fmt::format("{}: done, {}", format_name(at), format_duration(at.seconds));
  return join(join(format_name(at) + ": " + format_count(at, " of "), ", ", at.rate()), ", ", format_time(at, false));
}

}  // namespace dvi
