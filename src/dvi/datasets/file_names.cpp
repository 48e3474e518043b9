#include "dvi/datasets/file_names.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "dvi/core/error.h"
#include "dvi/core/natural_order.h"
#include "dvi/core/text.h"

namespace dvi::datasets {

const std::vector<std::string> kImageEndings = {".png", ".jpg", ".jpeg"};

namespace {

constexpr const char* kConversionRemedy = "convert them, for example with mogrify -format png";

// The endings of common image and video formats. Other files, such as Thumbs.db, are not reported.
const std::vector<std::string> kUnreadEndings = {".tif",  ".tiff", ".bmp",  ".webp", ".jp2",  ".ppm", ".pgm",  ".pnm",
                                                 ".exr",  ".hdr",  ".heic", ".heif", ".avif", ".jxl", ".gif",  ".tga",
                                                 ".dng",  ".raw",  ".cr2",  ".nef",  ".arw",  ".jpe", ".jfif", ".m4v",
                                                 ".webm", ".mts",  ".m2ts", ".wmv",  ".mpg",  ".mpeg"};

}  // namespace

std::string to_name_key(const std::string& name) {
  if (!is_all_digits(name)) return name;
  return name.substr(std::min(name.find_first_not_of('0'), name.size() - 1));
}

void require_one_file_per_name(const std::vector<fs::path>& files) {
  std::map<std::string, fs::path> by_key;
  for (const fs::path& file : files)
    if (const auto [other, added] = by_key.emplace(to_name_key(file.stem().string()), file); !added)
      throw InputError(file, "has the name or number of " + other->second.filename().string(), "remove one of the two");
}

std::optional<std::string> describe_order(const std::vector<std::string>& names) {
  if (std::all_of(names.begin(), names.end(), is_all_digits)) return std::nullopt;
  std::vector<std::string> natural = names, plain = names;
  std::sort(natural.begin(), natural.end(), natural_less);
  std::sort(plain.begin(), plain.end());
  const auto [first, other] = std::mismatch(natural.begin(), natural.end(), plain.begin());
  if (first == natural.end()) return std::nullopt;
  return fmt::format("frames are ordered by the numbers in their names: {} comes before {}", *first, *other);
}

std::optional<std::string> describe_unread_images(const fs::path& folder) {
  std::map<std::string, std::size_t> counts;
  for (const fs::path& file : list_files(folder, kUnreadEndings)) ++counts[to_lower_case(file.extension().string())];
  std::vector<std::string> parts;
  for (const auto& [ending, count] : counts) parts.push_back(fmt::format("{} file{} {}", count, count == 1 ? "" : "s", ending));
  if (parts.empty()) return std::nullopt;
  return fmt::format("{}", fmt::join(parts, ", "));
}

void warn_of_unread_images(Drive& drive, const fs::path& folder) {
  if (const auto unread = describe_unread_images(folder))
    drive.warnings.push_back(fmt::format("{} in {} are not read; supported formats are {}: {}", *unread, folder.string(),
                                         fmt::join(kImageEndings, ", "), kConversionRemedy));
}

void fail_without_images(const fs::path& folder, const std::string& problem, const std::string& remedy) {
  const auto unread = describe_unread_images(folder);
  if (!unread) throw InputError(folder, problem, remedy);
  throw InputError(folder, fmt::format("{}, but {}", problem, *unread),
                   fmt::format("supported formats are {} (videos: .mp4, .mkv, .mov, .avi): {}", fmt::join(kImageEndings, ", "),
                               kConversionRemedy));
}

}  // namespace dvi::datasets
