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

/// Files that are named by their numbers.
using Numbered = std::map<int, fs::path>;

/// Lists those of a folder; none if there is no such folder. Throws InputError if two files have one number.
Numbered numbered_files(const fs::path& folder, const std::vector<std::string>& endings);

/// The numbers from the drive's first frame to its last that are not among the files. can_list_numbers() holds.
std::vector<int> numbers_without(const Drive& drive, const Numbered& files);

/// Finds the frames between the first and the last that have no image or no scan; empty if the numbers cannot be
/// listed. Warns of scans before the first image or after
/// the last, whose images were lost or cut off, unless the options ask for a part of the drive.
std::vector<Gap> find_kitti_gaps(Drive& drive, const Numbered& images, const Numbered& scans, const ReadOptions& options);

/// A file of dates of KITTI: a line for each number of the whole drive, whichever excerpt is there; a blank one is lost.
class KittiStamps {
 public:
  explicit KittiStamps(const fs::path& file);
  /// The time of a number; InputError naming the line where there is none. `data` is the file that needs it.
  std::int64_t of(int number, const fs::path& data) const;
  /// The number of lines.
  std::size_t size() const { return lines_.size(); }
  /// The mean time from one line to the next: 0.1 s if the file does not tell.
  std::int64_t mean_step_ns() const;

 private:
  fs::path file_;
  std::vector<std::string> lines_;
};

}  // namespace dvi::datasets
