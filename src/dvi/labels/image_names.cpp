#include "dvi/labels/image_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::labels {
namespace {

constexpr auto kSuffixes = std::to_array<std::string_view>(
    {".jpg",         ".jpeg",        ".png",      ".bmp",           ".tif",   ".tiff",   ".webp",     "_mask",
     "-mask",        ".mask",        "_masks",    "_seg",           "_label", "_labels", "_instance", "_semantic",
     "_leftimg8bit", "_instanceids", "_labelids", "_labeltrainids", "_color", "_gtfine", "_gtcoarse"});
constexpr auto kPrefixes = std::to_array<std::string_view>({"mask_", "mask-", "frame_", "frame-", "image_", "img_"});
constexpr auto kRoboflowMarks = std::to_array<std::string_view>({"_png.rf.", "_jpg.rf.", "_jpeg.rf."});

// Label Studio adds eight hexadecimal digits and a hyphen before the name of an uploaded file.
bool has_upload_prefix(std::string_view name) {
  constexpr std::size_t kHashLength = 8;
  return name.size() > kHashLength + 1 && name[kHashLength] == '-' &&
         std::all_of(name.begin(), name.begin() + kHashLength,
                     [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
}

// Removes one addition of a tool. Returns false if there is none.
bool remove_addition(std::string& name) {
  const std::string lower = to_lower_case(name);
  for (const std::string_view mark : kRoboflowMarks)
    if (const std::size_t at = lower.find(mark); at != std::string::npos && at > 0) return name.resize(at), true;
  for (const std::string_view suffix : kSuffixes)
    if (lower.size() > suffix.size() && lower.ends_with(suffix)) return name.resize(name.size() - suffix.size()), true;
  for (const std::string_view prefix : kPrefixes)
    if (lower.size() > prefix.size() && lower.starts_with(prefix)) return name.erase(0, prefix.size()), true;
  if (has_upload_prefix(name)) return name.erase(0, name.find('-') + 1), true;
  return false;
}

std::string to_plain_image_name(const std::string& name) {
  std::string plain = name;
  while (remove_addition(plain)) {
  }
  return plain;
}

std::optional<int> find_number(const std::string& name) {
  const std::string plain = to_plain_image_name(name);
  return is_all_digits(plain) ? to_integer(plain) : std::nullopt;
}

/// Returns the numbers of names if all are different numbers.
std::optional<std::set<int>> find_numbers(const std::set<std::string>& names) {
  std::set<int> numbers;
  for (const std::string& name : names)
    if (const std::optional<int> number = find_number(name); !number || !numbers.insert(*number).second) return std::nullopt;
  return numbers;
}

void require_same_count(const fs::path& source, const std::set<std::string>& names, const std::set<std::string>& recorded) {
  constexpr std::size_t kMinNames = 3;  // fewer names do not show where the count begins
  if (names.size() < kMinNames || names.size() != recorded.size()) return;
  const auto given = find_numbers(names), images = find_numbers(recorded);
  if (!given || !images) return;
  const int shift = *given->begin() - *images->begin();
  const bool counts_alike =
      std::equal(given->begin(), given->end(), images->begin(), [&](int number, int image) { return number == image + shift; });
  if (std::abs(shift) == 1 && counts_alike)
    throw InputError(
        source,
        fmt::format("its names are {}, but those of the drive's images are {}: one of them seems to count from 1, so that "
                    "equal numbers would not match",
                    span_of(names), span_of(recorded)),
        fmt::format("give both the same names; if equal numbers do match, remove {}",
                    shift > 0 ? *names.rbegin() : *names.begin()));
}

/// A part of names by which they are matched.
struct NameKey {
  std::string (*of_name)(const std::string&);  ///< an empty text for a name without this part
  bool is_in_all_names;
  const char* description;
};

// Matches names by a key. Returns nothing if no name, or not every name as the key requires, has the key of an image.
std::optional<MatchedNames> match_by(const NameKey& key, const fs::path& source, const std::vector<std::string>& names,
                                     const std::set<std::string>& recorded) {
  std::map<std::string, std::string> image_of;
  for (const std::string& image : recorded)
    if (const std::string of_image = key.of_name(image); !of_image.empty() && !image_of.emplace(of_image, image).second)
      return std::nullopt;
  MatchedNames out;
  std::map<std::string, std::string> first;  // name by image
  for (const std::string& name : names) {
    const auto found = image_of.find(key.of_name(name));
    if (found == image_of.end() && key.is_in_all_names) return std::nullopt;
    out.images.push_back(found == image_of.end() ? std::nullopt : std::optional(found->second));
    if (found == image_of.end()) continue;
    if (const auto [other, fresh] = first.emplace(found->second, name); !fresh && other->second != name)
      throw InputError(source, fmt::format("{} and {} both match image {}", other->second, name, found->second),
                       "keep one of them per image");
  }
  if (first.empty()) return std::nullopt;
  const fs::path named = source.has_filename() ? source : source.parent_path();
  out.warning = fmt::format("{}: names are matched by {}, such as {} to image {}", named.filename().string(), key.description,
                            first.begin()->second, first.begin()->first);
  return out;
}

std::string to_number_key(const std::string& name) {
  const std::optional<int> number = find_number(name);
  return number ? std::to_string(*number) : "";
}

constexpr NameKey kPlainNames{to_plain_image_name, false, "their part without additions of tools"};
constexpr NameKey kNumbers{to_number_key, true, "number"};

}  // namespace

std::string span_of(const std::set<std::string>& names) {
  if (names.empty()) return "none";
  const auto by_length = [](const std::string& a, const std::string& b) { return a.size() < b.size(); };
  const bool numbers = std::all_of(names.begin(), names.end(), [](const std::string& name) { return is_all_digits(name); });
  std::vector<std::string> sorted(names.begin(), names.end());
  if (numbers) std::stable_sort(sorted.begin(), sorted.end(), by_length);
  return sorted.size() == 1 ? sorted.front() : sorted.front() + " to " + sorted.back();
}

MatchedNames match_names(const fs::path& source, const std::vector<std::string>& names, const std::set<std::string>& recorded) {
  MatchedNames equal;
  for (const std::string& name : names) equal.images.push_back(recorded.contains(name) ? std::optional(name) : std::nullopt);
  const std::set<std::string> distinct(names.begin(), names.end());
  require_same_count(source, distinct, recorded);
  if (std::any_of(equal.images.begin(), equal.images.end(), [](const auto& image) { return image.has_value(); })) return equal;
  if (auto plain = match_by(kPlainNames, source, names, recorded)) return *plain;
  if (auto numbered = match_by(kNumbers, source, names, recorded)) return *numbered;
  return equal;
}

}  // namespace dvi::labels
