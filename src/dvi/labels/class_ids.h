#pragma once

#include <set>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/drive.h"

namespace dvi::labels {

/// Ids from this number on are those of instances: class * 1000 + instance, as in Cityscapes and KITTI-360.
inline constexpr int kInstancesPerClass = 1000;
/// The corresponding factor of KITTI's instance images: class * 256 + instance.
inline constexpr int kKittiInstancesPerClass = 256;

/// The classes that `--classes` selects in images of class ids.
struct ChosenClasses {
  std::set<int> ids;
  std::vector<cv::Vec3b> colors;  ///< BGR colors of the Cityscapes palette
  int instances_per_class = kInstancesPerClass;
};

/// Parses "car,truck", "semantic-kitti:moving-car" or "26,27": names of a table, or ids. Without a table, the names are those
/// of Cityscapes and KITTI-360, which have the same ids. Throws UsageError with the existing names if one is unknown.
ChosenClasses parse_classes(const std::string& text);

/// Returns whether all colors of a BGR image are in the Cityscapes palette and not all are black.
bool has_class_colors(const cv::Mat3b& picture);

/// Returns a mask that is 255 at the pixels of the chosen classes: by value (one channel of 8 or 16 bits) or by color.
cv::Mat1b make_class_mask(const cv::Mat& picture, const ChosenClasses& classes);

/// Returns whether 16-bit values are those of KITTI's instance images: no value is an id alone, all are of known classes, and
/// the instance number is 0 for at least a quarter of the pixels, as for roads and buildings.
bool are_kitti_ids(const std::vector<cv::Mat>& pictures);

/// Adds a warning about labels of types that are not known as traffic; they are removed like all others.
void warn_of_unknown_types(Drive& drive);

/// Keeps only the labels of the types in `text`, such as "car,van". Adds a warning about a type that no label has. Throws
/// UsageError with the existing types if no label has any of them.
void keep_label_types(Drive& drive, const std::string& text);

}  // namespace dvi::labels
