#pragma once

#include <numeric>

#include "dvi/labels/labels.h"
#include "parser.h"

namespace dvi::fuzz {

/// Three frames, "0" to "2", of 8x6 pixels, of a camera called front.
inline Drive small_drive() {
  Drive drive;
  drive.camera.width = 8, drive.camera.height = 6;
  drive.camera_name = "front";
  for (int i = 0; i < 3; ++i) drive.frames.push_back({i, std::to_string(i), i, {}, {}});
  return drive;
}

/// What holds of labels that were drawn in its images.
inline void require_in_images(const labels::NamedLabels& read) {
  const cv::Rect2d image(0, 0, 8, 6);
  for (const auto& [name, labels] : read.frames)
    for (const Label& label : labels) {
      if (label.rect) require((*label.rect & image) == *label.rect, "a box lies in its image");
      if (label.instance)
        require(std::accumulate(label.instance->runs.begin(), label.instance->runs.end(), std::int64_t{0}) == 48,
                "runs fill the image");
    }
}

}  // namespace dvi::fuzz
