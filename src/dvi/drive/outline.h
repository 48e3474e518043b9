#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/label.h"
#include "dvi/geometry/camera.h"

namespace dvi {

/// Returns the outline of the pixels of a mask that are not 0.
Instance to_outline(const cv::Mat1b& mask);

/// Does the same for a mask that is a part of an image of `size`, with the first pixel `corner`. The part must lie within the
/// image.
Instance to_outline(const cv::Mat1b& part, cv::Point corner, cv::Size size);

/// The corners of a polygon in order, in the axes of annotation tools: pixel (x, y) is the square from (x, y) to (x + 1, y +
/// 1).
using Polygon = std::vector<cv::Point2d>;

/// Returns the outline of the pixels of an image whose centers lie in any of the polygons (even-odd rule for each). Corners may
/// lie up to 1e9 pixels outside the image.
Instance to_outline(const std::vector<Polygon>& polygons, cv::Size size);

/// Sets the pixels of an outline within the mask to 255.
void draw(const Instance& outline, cv::Mat1b& mask);

/// Draws the outlines of labels, all of which must have one, into an empty mask.
cv::Mat1b draw_instances(const std::vector<Label>& labels, cv::Size size);

/// The distance in meters in front of the camera below which points are not projected.
inline constexpr double kNearPlane = 0.3;

/// Returns whether a point in camera axes can be drawn: it is beyond the near plane, or has a projection of a camera that is
/// wide and that distance.
inline bool is_beyond_near_plane(const Eigen::Vector3d& x, const Camera& camera) {
  return camera.depth(x) >= kNearPlane && (!camera.is_wide() || camera.in_front(x));
}

/// Sets the convex hull of those points in camera axes that are beyond the near plane to 255. Returns false if there are none.
bool draw_hull(const std::vector<Eigen::Vector3d>& points, const Camera& camera, cv::Mat1b& mask);

/// Rounds image coordinates to a pixel for drawing, clamped near the image so that the drawing's integers do not overflow. NaN,
/// which is a result of extreme distortion, becomes the lower limit.
cv::Point to_drawing_pixel(double x, double y);

}  // namespace dvi
