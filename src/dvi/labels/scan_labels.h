#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/drive.h"

namespace dvi::labels {

/// Finds the folder of labels of points: the given one, or its subfolder labels/ or predictions/, as in SemanticKITTI. It has a
/// file NAME.label per scan, with one little-endian uint32 per point (PointLabels).
std::optional<fs::path> find_point_label_folder(const fs::path& given);

/// Reads the labels in one file. Throws InputError if its size is not a multiple of four bytes.
std::vector<std::uint32_t> read_point_labels(const fs::path& file);

/// Returns the ids of the removed classes: those in `classes` (class_ids.h; names are those of SemanticKITTI), or all classes
/// of traffic if it is empty. If `moving_only`, without those of stationary objects. Throws UsageError for unknown names.
std::set<int> select_point_classes(const std::string& classes, bool moving_only);

/// Sets drive.point_labels to the labels of these classes in folders, and adds their files to the drive. If several folders
/// label a return, the first one counts. Adds warnings about scans without labels, and if no label has a removed class. Throws
/// InputError if the drive has no scans, no scan has labels, or a file is damaged; reading an item throws it if a file does not
/// have one label per point of its scan.
void attach_point_labels(Drive& drive, const std::vector<fs::path>& folders, const std::set<int>& classes);

}  // namespace dvi::labels
