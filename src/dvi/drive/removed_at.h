#pragma once

#include <algorithm>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/label.h"
#include "dvi/geometry/camera.h"

namespace dvi {

/// Returns whether a point in LiDAR axes lies in the 3D box of any label, enlarged by a margin in meters.
inline bool is_in_any_box(const std::vector<Label>& labels, const Eigen::Vector3d& in_lidar, double margin_m) {
  return std::any_of(labels.begin(), labels.end(),
                     [&](const Label& l) { return l.box && l.box->contains(in_lidar, margin_m); });
}

/// The content of an image at a point: outside the image, an object that is removed, or background.
enum class InImage { unseen, removed, background };
inline InImage in_image(const Eigen::Vector3d& in_camera, const Camera& camera, const cv::Mat1b& mask) {
  if (!camera.in_front(in_camera)) return InImage::unseen;
  const Eigen::Vector2d pixel = camera.project(in_camera);
  if (!camera.contains(pixel)) return InImage::unseen;
  return mask(cvRound(pixel.y()), cvRound(pixel.x())) != 0 ? InImage::removed : InImage::background;
}

}  // namespace dvi
