#include <cmath>

#include "dvi/core/text.h"
#include "dvi/labels/labels.h"

namespace dvi::labels {
namespace {

// Columns of a line of KITTI's tracking labels; 17 may be a score.
enum Column { frame, track, type, truncated, occluded, alpha, left, top, right, bottom, height, width, length, x, y, z, yaw };

// KITTI gives the center of a box's bottom face in the axes of a camera (y down), and the yaw about y.
Box to_box(const TextLine& line, const SE3& lidar_from_camera) {
  const double c = std::cos(line.number(yaw)), s = std::sin(line.number(yaw));
  const Eigen::Vector3d size(line.number(length), line.number(width), line.number(height));
  SE3 camera_from_box;
  camera_from_box.R << c, s, 0, 0, 0, -1, -s, c, 0;
  camera_from_box.t = {line.number(x), line.number(y) - 0.5 * size.z(), line.number(z)};
  return {lidar_from_camera * camera_from_box, size};
}

}  // namespace

LabelsByNumber read_kitti_tracking(const fs::path& file, const SE3& lidar_from_camera) {
  LabelsByNumber labels;
  for (const TextLine& line : read_text_lines(file)) {
    Label label;
    label.type = to_lower_case(line.word(type));
    std::vector<Label>& frame_labels = labels[line.integer(frame)];
    if (label.type == "dontcare") continue;
    if (line.size() < yaw + 1) line.fail("has " + std::to_string(line.size()) + " entries instead of 17");
    label.track = line.integer(track);
    label.rect =
        cv::Rect2d(cv::Point2d(line.number(left), line.number(top)), cv::Point2d(line.number(right), line.number(bottom)));
    // Objects without a 3D box have sizes of -1.
    if (line.number(height) > 0 && line.number(width) > 0 && line.number(length) > 0)
      label.box = to_box(line, lidar_from_camera);
    frame_labels.push_back(std::move(label));
  }
  return labels;
}

}  // namespace dvi::labels
