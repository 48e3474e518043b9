#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/mask_source.h"
#include "dvi/geometry/box.h"

namespace dvi {

/// The outline of one object in one image: run lengths in column-major order, beginning with background (COCO).
struct Instance {
  cv::Size size;
  std::vector<std::uint32_t> runs;
};

/// One labeled object in one frame; the labels have some of its shapes.
struct Label {
  int track = -1;
  std::string type;                ///< the class in the labels, in lower case ("car", "van", "pedestrian")
  std::optional<Box> box;          ///< in LiDAR axes, at the time of the image
  std::optional<cv::Rect2d> rect;  ///< in the image, in pixels
  std::optional<Instance> instance;
  MaskSource source = MaskSource::labels;  ///< of the object
  int class_number = -1;                   ///< the number of the class in the label file, by which --classes can select it
};

/// The labels of each frame of a drive.
using FrameLabels = std::vector<std::vector<Label>>;
/// The labels of a drive, shared by all readers because a long drive has many.
using SharedLabels = std::shared_ptr<const FrameLabels>;
inline SharedLabels shared(FrameLabels labels) { return std::make_shared<const FrameLabels>(std::move(labels)); }

}  // namespace dvi
