#pragma once

#include <set>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/drive.h"

namespace dvi::labels {

/// Ids of a number of this and above are those of instances: class * 1000 + the instance, as Cityscapes and KITTI-360 have
/// them.
inline constexpr int kIdsOfAClass = 1000;
/// The same in KITTI's instance pictures: class * 256 + the instance.
inline constexpr int kKittiIdsOfAClass = 256;

/// What `--classes` names in pictures of class ids.
struct ChosenClasses {
  std::set<int> ids;
  std::vector<cv::Vec3b> colors;  ///< BGR, of the Cityscapes palette
  int ids_of_a_class = kIdsOfAClass;
};

/// "car,truck", "semantic-kitti:moving-car" or "26,27": names of a table, or ids. Without a table the names are those of
/// Cityscapes and KITTI-360, which share their ids. UsageError with the names there are.
ChosenClasses parse_classes(const std::string& text);

/// Whether each color of a BGR picture is one of the Cityscapes palette, and not all are black.
bool has_class_colors(const cv::Mat3b& picture);

/// 255 where the pixel is of a chosen class: by value, of 8 or 16 bits and one channel, or by color.
cv::Mat1b mask_of_classes(const cv::Mat& picture, const ChosenClasses& classes);

/// Whether 16-bit values are those of KITTI's instance pictures: none is an id alone, all are of known classes, and of a
/// quarter of the pixels or more the number of the instance is 0, as of streets and houses.
bool are_kitti_ids(const std::vector<cv::Mat>& pictures);

/// Warns of labels of types that are not known as traffic: they are removed like all others.
void warn_of_unknown_types(Drive& drive);

/// Keeps the labels of the types that `text` names, such as "car,van". Warns of a type that no label has; UsageError, with the
/// types there are, where none of them is one.
void keep_label_types(Drive& drive, const std::string& text);

}  // namespace dvi::labels
