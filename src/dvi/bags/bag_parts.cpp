#include "dvi/bags/bag_parts.h"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/bags/bag_metadata.h"
#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::bags {
namespace {

constexpr const char* kBagEndings[] = {".mcap", ".db3", ".bag"};

std::vector<fs::path> list_bags(const fs::path& folder) { return list_files(folder, {".mcap", ".db3", ".bag"}); }

// The name and number of a part: "drive_12.db3" is part 12. ROS 1 puts the time before the number.
struct PartName {
  std::string prefix;
  std::size_t number = 0;

  /// Returns the name with digits replaced. The parts of one recording have the same pattern.
  std::string pattern() const {
    std::string out = prefix;
    std::replace_if(out.begin(), out.end(), [](char c) { return c >= '0' && c <= '9'; }, '0');
    return out;
  }
};

std::optional<PartName> parse_part_name(const fs::path& file) {
  constexpr std::size_t kMaxDigits = 6;
  const std::string stem = file.stem().string();
  const std::size_t mark = stem.rfind('_');
  if (mark == std::string::npos) return std::nullopt;
  const std::string digits = stem.substr(mark + 1);
  const bool is_number = !digits.empty() && digits.size() <= kMaxDigits && is_all_digits(digits);
  if (!is_number || (digits.size() > 1 && digits.front() == '0')) return std::nullopt;
  return PartName{stem.substr(0, mark + 1), std::stoul(digits)};
}

// Returns the files by number if all are parts of one recording that begins with number 0; nothing otherwise.
std::optional<std::map<std::size_t, fs::path>> number_parts(const std::vector<fs::path>& files) {
  std::map<std::size_t, fs::path> parts;
  std::set<std::string> patterns;
  for (const fs::path& file : files) {
    const auto name = parse_part_name(file);
    if (!name || !parts.emplace(name->number, file).second) return std::nullopt;
    patterns.insert(name->pattern() + file.extension().string());
  }
  if (patterns.size() != 1 || !parts.contains(0)) return std::nullopt;
  return parts;
}

void use_names(BagParts& parts) {
  constexpr std::size_t kMaxParts = 100'000;
  const auto numbered = number_parts(parts.files);
  if (!numbered || numbered->rbegin()->first > kMaxParts) return;
  const std::string prefix = parse_part_name(parts.files.front()).value().prefix;
  const bool same_prefix = std::all_of(parts.files.begin(), parts.files.end(),
                                       [&](const fs::path& file) { return parse_part_name(file).value().prefix == prefix; });
  parts.files.clear();
  std::vector<std::string> names;
  std::size_t next = 0;
  for (const auto& [number, file] : *numbered) {
    for (; next < number; ++next) {
      names.push_back(same_prefix ? fmt::format("{}{}{}", prefix, next, file.extension().string())
                                  : fmt::format("part {}", next));
      parts.missing.push_back({names.back(), parts.files.size()});
    }
    parts.files.push_back(file);
    next = number + 1;
  }
  if (!names.empty())
    parts.warnings.push_back(fmt::format("judging by the numbers of the files, {} {} missing", fmt::join(names, ", "),
                                         names.size() == 1 ? "is" : "are"));
}

void use_metadata(const fs::path& folder, const BagMetadata& metadata, BagParts& parts) {
  std::set<std::string> unlisted;
  for (const fs::path& file : parts.files) unlisted.insert(file.filename().string());
  BagParts listed;
  std::vector<std::string> missing;
  for (const std::string& name : metadata.files) {
    const bool is_compressed = fs::path(name).extension() == ".zstd";
    const std::string decompressed = is_compressed ? fs::path(name).stem().string() : name;
    if (unlisted.erase(decompressed) > 0) {
      listed.files.push_back(folder / decompressed);
    } else if (is_compressed && fs::exists(folder / name)) {
      throw InputError(folder / name, "is compressed as a whole, which is not supported", "decompress it by zstd -d FILE");
    } else {
      missing.push_back(name);
      listed.missing.push_back({name, listed.files.size()});
    }
  }
  if (parts.files.empty())
    throw InputError(folder, fmt::format("has none of the files that metadata.yaml lists: {}", fmt::join(missing, ", ")),
                     "copy them into the folder");
  if (!missing.empty())
    parts.warnings.push_back(
        fmt::format("metadata.yaml lists {}, which {} missing", fmt::join(missing, ", "), missing.size() == 1 ? "is" : "are"));
  if (listed.files.empty()) return;  // the files were renamed
  if (!unlisted.empty())
    parts.warnings.push_back(
        fmt::format("metadata.yaml does not list {}; the additional files are read as well", fmt::join(unlisted, ", ")));
  for (const std::string& name : unlisted) listed.files.push_back(folder / name);
  parts.files = std::move(listed.files), parts.missing = std::move(listed.missing), parts.counts = metadata.counts;
}

// Lists the files of the recording that a file belongs to, in order; only that file if it belongs to none.
std::vector<std::string> list_recording_names(const fs::path& file) {
  const std::string own = file.filename().string();
  if (const auto metadata = read_bag_metadata(file.parent_path())) {
    const bool is_listed = std::count(metadata->files.begin(), metadata->files.end(), own) > 0;
    return is_listed ? metadata->files : std::vector<std::string>{own};
  }
  const auto name = parse_part_name(file);
  if (!name) return {own};
  std::vector<fs::path> similar;
  for (const fs::path& other : list_bags(file.parent_path()))
    if (const auto part = parse_part_name(other); part && part->pattern() == name->pattern()) similar.push_back(other);
  std::vector<std::string> out;
  for (const auto& [number, part] : number_parts(similar).value_or(std::map<std::size_t, fs::path>{{name->number, file}}))
    out.push_back(part.filename().string());
  return out;
}

BagParts find_part(const fs::path& file) {
  BagParts parts{.files = {file}, .missing = {}, .counts = {}, .warnings = {}};
  const std::vector<std::string> names = list_recording_names(file);
  if (names.size() < 2) return parts;
  const bool is_first = names.front() == file.filename().string();
  parts.warnings.push_back(fmt::format(
      "{} is one of {} files of a recording and is read alone{}; give the folder to read all of them", file.filename().string(),
      names.size(), is_first ? "" : ": its frames are numbered from 0, and masks of the whole recording do not match"));
  return parts;
}

}  // namespace

bool has_bag_ending(const fs::path& file) {
  const std::string ending = to_lower_case(file.extension().string());
  return std::find(std::begin(kBagEndings), std::end(kBagEndings), ending) != std::end(kBagEndings);
}

BagParts find_bag_parts(const fs::path& path) {
  if (!fs::is_directory(path)) return find_part(path);
  BagParts parts;
  parts.files = list_bags(path);
  // The order is numeric, so that 10 comes after 9.
  std::stable_sort(parts.files.begin(), parts.files.end(),
                   [](const fs::path& a, const fs::path& b) { return a.string().size() < b.string().size(); });
  if (const auto metadata = read_bag_metadata(path); metadata && !metadata->files.empty())
    use_metadata(path, *metadata, parts);
  else
    use_names(parts);
  return parts;
}

}  // namespace dvi::bags
