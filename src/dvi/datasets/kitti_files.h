#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/datasets/reader.h"
#include "dvi/drive/drive.h"
#include "dvi/drive/gap.h"

namespace dvi::datasets {

/// Files by the number in their names.
using NumberedFiles = std::map<int, fs::path>;

/// Lists the numbered files of a folder; none if there is no such folder. Throws InputError if two files have the same number.
NumberedFiles list_numbered_files(const fs::path& folder, const std::vector<std::string>& endings);

/// Returns the numbers from the drive's first frame to its last that are not among the files. Requires can_list_numbers().
std::vector<int> find_numbers_without(const Drive& drive, const NumberedFiles& files);

/// Finds the frames between the first and the last one that have no image or no scan; none if the numbers cannot be listed.
/// Adds a warning about scans before the first or after the last image, whose images are missing, unless the options select a
/// part of the drive.
std::vector<Gap> find_kitti_gaps(Drive& drive, const NumberedFiles& images, const NumberedFiles& scans,
                                 const ReadOptions& options);

/// The times of a KITTI timestamps file. It has a line for each number of the whole drive, also for an excerpt; an empty line
/// means that the frame was lost.
class KittiStamps {
 public:
  explicit KittiStamps(const fs::path& file);
  /// Returns the time of a number. Throws InputError with the line number if there is none; `data` is the file that needs it.
  std::int64_t of(int number, const fs::path& data) const;
  /// Returns the number of lines.
  std::size_t size() const { return lines_.size(); }
  /// Returns the mean time from one line to the next; 0.1 s if the file has fewer than two times.
  std::int64_t mean_step_ns() const;

 private:
  fs::path file_;
  std::vector<std::string> lines_;
};

}  // namespace dvi::datasets
