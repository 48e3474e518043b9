#include "dvi/result/section_folder.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/hash.h"
#include "dvi/result/fingerprints.h"
#include "dvi/result/plan_manifest.h"

namespace dvi::result {
namespace {

fs::path cuts_folder(const fs::path& out) { return out / ".dvi/sections"; }

bool is_planned(const fs::path& section) {
  return fs::is_regular_file(section / ".dvi/plan.json") && fs::is_regular_file(options_of_whole(section));
}

/// Returns the numbers of the sections of a cut that are not planned, ascending.
std::vector<std::size_t> find_unplanned(const fs::path& out, std::size_t count) {
  std::vector<std::size_t> missing;
  for (std::size_t number = 1; number <= count; ++number)
    if (!is_planned(section_folder(out, number, count))) missing.push_back(number);
  return missing;
}

std::optional<std::size_t> parse_count(const std::string& text) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(count) : std::nullopt;
}

/// Returns the numbers of sections of all cuts in OUT, ascending.
std::vector<std::size_t> list_cuts(const fs::path& out) {
  std::vector<std::size_t> cuts;
  if (!fs::is_directory(cuts_folder(out))) return cuts;
  for (const fs::directory_entry& entry : fs::directory_iterator(cuts_folder(out)))
    if (const auto count = parse_count(entry.path().filename().string()); count && entry.is_directory()) cuts.push_back(*count);
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

std::string describe_missing(const std::vector<std::size_t>& missing, std::size_t count) {
  return fmt::format("{} {} of {} {} not planned", missing.size() == 1 ? "section" : "sections", fmt::join(missing, ", "),
                     count, missing.size() == 1 ? "is" : "are");
}

/// Returns the first line in which two texts differ, of both.
std::pair<std::string, std::string> find_difference(const std::string& a, const std::string& b) {
  std::istringstream in_a(a), in_b(b);
  std::string line_a, line_b;
  do {
    if (!std::getline(in_a, line_a)) line_a = "(end)";
    if (!std::getline(in_b, line_b)) line_b = "(end)";
  } while (line_a == line_b && line_a != "(end)");
  return {line_a, line_b};
}

}  // namespace

fs::path section_folder(const fs::path& out, std::size_t number, std::size_t count) {
  return cuts_folder(out) / std::to_string(count) / std::to_string(number);
}

fs::path options_of_whole(const fs::path& section) { return section / "whole.toml"; }

bool has_sections(const fs::path& out) {
  std::error_code ignored;  // a folder that another process removes has none
  for (fs::recursive_directory_iterator entry(cuts_folder(out), ignored), end; !ignored && entry != end;
       entry.increment(ignored))
    if (entry->is_regular_file(ignored)) return true;
  return false;
}

std::size_t find_planned_sections(const fs::path& out) {
  const std::vector<std::size_t> cuts = list_cuts(out);
  if (cuts.empty())
    throw InputError(out, "does not contain plans of sections", "make them with dvi plan TARGET -o OUT --section 1/N to N/N");
  std::vector<std::size_t> complete;
  std::vector<std::string> incomplete;
  for (const std::size_t count : cuts)
    if (const std::vector<std::size_t> missing = find_unplanned(out, count); missing.empty())
      complete.push_back(count);
    else
      incomplete.push_back(describe_missing(missing, count));
  if (complete.empty())
    throw InputError(out, fmt::format("{}", fmt::join(incomplete, "; ")), "plan them: dvi plan TARGET -o OUT --section K/N");
  if (complete.size() > 1)
    throw InputError(out, fmt::format("has complete plans in {} sections", fmt::join(complete, " and in ")),
                     fmt::format("remove one of them: {}/N", cuts_folder(out).string()));
  require_planned_sections(out, complete.front());
  return complete.front();
}

void require_planned_sections(const fs::path& out, std::size_t count) {
  if (const std::vector<std::size_t> missing = find_unplanned(out, count); !missing.empty())
    throw InputError(out, describe_missing(missing, count),
                     fmt::format("dvi plan TARGET -o OUT --section {}/{} plans the first of them", missing.front(), count));
  const std::string program = program_fingerprint(), first = read_file(options_of_whole(section_folder(out, 1, count)));
  for (std::size_t number = 1; number <= count; ++number) {
    const fs::path section = section_folder(out, number, count);
    const PlanManifest plan = read_plan(section);
    if (plan.program != program)
      throw InputError(
          section, fmt::format("section {} was planned by another build of dvi (version {})", number, plan.version),
          fmt::format("use the same program on all machines, or plan the section again (--section {}/{})", number, count));
    if (const std::string options = read_file(options_of_whole(section)); options != first) {
      const auto [line, other] = find_difference(options, first);
      throw InputError(section,
                       fmt::format("section {} was planned with other options than section 1: \"{}\" instead of \"{}\"", number,
                                   line, other),
                       "plan all sections with the same options");
    }
  }
}

std::string content_of_sections(const fs::path& out, std::size_t count) {
  Fingerprint print;
  for (std::size_t number = 1; number <= count; ++number) print.add(read_plan(section_folder(out, number, count)).content);
  return print.hex();
}

}  // namespace dvi::result
