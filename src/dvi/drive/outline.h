#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "dvi/drive/label.h"
#include "dvi/geometry/camera.h"

namespace dvi {

/// The outline of the pixels of a mask that are not 0.
Instance outline_of(const cv::Mat1b& mask);

/// The same of a mask that is the part of an image of `size` whose first pixel is `corner`. It lies within the image.
Instance outline_of(const cv::Mat1b& part, cv::Point corner, cv::Size size);

/// Corners in order, in the axes of annotation tools: pixel (x, y) is the square from (x, y) to (x + 1, y + 1).
using Polygon = std::vector<cv::Point2d>;

/// The outline of the pixels of an image whose centers lie in any of the polygons (even-odd in each). Corners may lie outside
/// of the image, less than 1e9 pixels.
Instance outline_of(const std::vector<Polygon>& polygons, cv::Size size);

/// Sets the outline's pixels within the mask to 255.
void draw(const Instance& outline, cv::Mat1b& mask);

/// Meters in front of the camera; what is nearer has no place in the image.
inline constexpr double kNearPlane = 0.3;

/// Sets the convex hull of points in camera axes to 255, of those beyond the near plane. False where there are none.
bool draw_hull(const std::vector<Eigen::Vector3d>& points, const Camera& camera, cv::Mat1b& mask);

/// A whole pixel of a mask's axes, for drawing: rounded, and held near enough to the image that the drawing's integers do not
/// overflow. NaN, which extreme distortion makes, goes to the lower end.
cv::Point drawing_pixel(double x, double y);

}  // namespace dvi
