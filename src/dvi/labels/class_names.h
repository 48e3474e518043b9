#pragma once

#include <map>
#include <string>

#include "dvi/core/files.h"

namespace dvi::labels {

/// The names of classes by number, in lower case, and the file that states them.
struct ClassNames {
  std::map<int, std::string> names;  ///< empty if there is no such file
  fs::path file;
};

/// Reads the names of the classes of YOLO labels: the key `names` of data.yaml or dataset.yaml, as a list or a map, in block
/// style or in brackets, or the lines of classes.txt or obj.names. The file lies in the folder of the labels or in one of the
/// two folders above it. Throws InputError if a YAML file has no names that can be read.
ClassNames find_class_names(const fs::path& folder);

/// Returns whether a file of this name lists classes or images, so that it is not the label file of an image.
bool is_yolo_list(const fs::path& file);

}  // namespace dvi::labels
