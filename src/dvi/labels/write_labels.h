#pragma once

#include <string>
#include <vector>

#include "dvi/core/files.h"
#include "dvi/drive/outline.h"

namespace dvi::labels {

/// One object in one image.
struct DrawnObject {
  int track = -1;
  std::string type;
  std::vector<Polygon> parts;  ///< the largest first
  int pixels = 0;              ///< the number of its pixels
};

/// One labeled image.
struct DrawnImage {
  std::string file_name;
  int index = 0;  ///< among all images of the recording, from 0
  std::vector<DrawnObject> objects;
};

/// The labels of a camera for other tools.
struct DrawnLabels {
  cv::Size size;
  int recorded_images = 0;  ///< the number of images of the recording, not only those below
  std::vector<DrawnImage> images;
};

/// Writes COCO JSON: one annotation with polygons per object and image, with `track_id`.
void write_coco(const fs::path& file, const DrawnLabels& labels);

/// Writes CVAT XML 1.1 for video: a track per object, and one more for each further part of it, because a shape of CVAT is one
/// polygon. Each shape is a key frame.
void write_cvat(const fs::path& file, const DrawnLabels& labels);

}  // namespace dvi::labels
