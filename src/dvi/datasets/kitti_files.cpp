#include "dvi/datasets/kitti_files.h"

#include <cstdint>
#include <optional>
#include <utility>

#include "dvi/core/error.h"
#include "dvi/core/text.h"

namespace dvi::datasets {

NumberedFiles list_numbered_files(const fs::path& folder, const std::vector<std::string>& endings) {
  NumberedFiles files;
  for (const fs::path& file : list_files(folder, endings))
    if (is_all_digits(file.stem().string()))
      if (const auto number = to_integer(file.stem().string()))
        if (const auto [other, added] = files.emplace(*number, file); !added)
          throw InputError(file, "has the number of " + other->second.filename().string(), "remove one of the two");
  return files;
}

std::vector<int> find_numbers_without(const Drive& drive, const NumberedFiles& files) {
  std::vector<int> missing;
  for (std::int64_t number = drive.frames.front().number; number <= drive.frames.back().number; ++number)
    if (!files.contains(static_cast<int>(number))) missing.push_back(static_cast<int>(number));
  return missing;
}

std::vector<Gap> find_kitti_gaps(Drive& drive, const NumberedFiles& images, const NumberedFiles& scans,
                                 const ReadOptions& options) {
  std::vector<Gap> gaps;
  if (can_list_numbers(drive, 1))
    gaps = {{"no image for frames", find_numbers_without(drive, images)},
            {"no scan for frames", find_numbers_without(drive, scans)}};
  if (options.frames || options.span) return gaps;
  std::vector<int> outside;
  for (const auto& [number, file] : scans)
    if (number < drive.frames.front().number || number > drive.frames.back().number) outside.push_back(number);
  if (!outside.empty()) drive.warnings.push_back("no image for scans " + format_ranges(outside));
  return gaps;
}

KittiStamps::KittiStamps(const fs::path& file) : file_(file) {
  if (!fs::exists(file)) throw InputError(file, "is missing", "use the file as published by KITTI");
  lines_ = read_lines(file);
}

std::int64_t KittiStamps::mean_step_ns() const {
  std::int64_t step = 100'000'000;
  std::optional<std::pair<std::size_t, std::int64_t>> first;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const auto time = date_to_nanoseconds(lines_[i]);
    if (time && first) step = (*time - first->second) / static_cast<std::int64_t>(i - first->first);
    if (time && !first) first = {i, *time};
  }
  return step;
}

std::int64_t KittiStamps::of(int number, const fs::path& data) const {
  const std::string place = file_.string() + ":" + std::to_string(number + 1);
  if (static_cast<std::size_t>(number) >= lines_.size())
    throw InputError(file_, "ends before line " + std::to_string(number + 1) + ", the time of " + data.filename().string(),
                     "use the file of the whole drive, as published by KITTI");
  const std::string& line = lines_[static_cast<std::size_t>(number)];
  const bool cut = &line == &lines_.back() && !line.empty() && line.size() < lines_.front().size();
  if (cut) throw InputError(place, "'" + line + "' is shorter than the lines before it: the file is truncated");
  if (const auto time = date_to_nanoseconds(line)) return *time;
  throw InputError(place, line.empty() ? "the line is empty, but " + data.filename().string() + " exists"
                                       : "'" + line + "' is not a time YYYY-MM-DD HH:MM:SS.nnnnnnnnn");
}

}  // namespace dvi::datasets
