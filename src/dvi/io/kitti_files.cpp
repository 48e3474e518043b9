#include "dvi/io/kitti_files.h"

#include "dvi/core/error.h"
#include "dvi/io/text.h"

namespace dvi::io {

Numbered numbered_files(const fs::path& folder, const std::vector<std::string>& endings) {
  Numbered files;
  for (const fs::path& file : list_files(folder, endings))
    if (all_digits(file.stem().string()))
      if (const auto number = to_integer(file.stem().string())) files[*number] = file;
  return files;
}

std::vector<int> numbers_without(const Drive& drive, const Numbered& files) {
  std::vector<int> missing;
  for (int number = drive.frames.front().number; number <= drive.frames.back().number; ++number)
    if (!files.contains(number)) missing.push_back(number);
  return missing;
}

KittiStamps::KittiStamps(const fs::path& file) : file_(file), lines_(read_lines(file)) {}

std::int64_t KittiStamps::of(int number, const fs::path& data) const {
  const std::string place = file_.string() + ":" + std::to_string(number + 1);
  if (static_cast<std::size_t>(number) >= lines_.size())
    throw InputError(file_, "ends before line " + std::to_string(number + 1) + ", the time of " + data.filename().string());
  const std::string& line = lines_[static_cast<std::size_t>(number)];
  const bool cut = &line == &lines_.back() && !line.empty() && line.size() < lines_.front().size();
  if (cut) throw InputError(place, "'" + line + "' is shorter than the lines before it: the file was cut");
  if (const auto time = date_to_nanoseconds(line)) return *time;
  throw InputError(place, line.empty() ? "the line is empty, and " + data.filename().string() + " is there"
                                       : "'" + line + "' is no time YYYY-MM-DD HH:MM:SS.nnnnnnnnn");
}

}  // namespace dvi::io
