#include "dvi/drive/outline.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dvi {
namespace {

// The order of the arguments turns NaN into the lower limit.
int clamp_to_drawing(double place) { return static_cast<int>(std::max(-1e5, std::min(std::round(place), 1e5))); }

// Returns the pixels of an image that polygons can cover.
cv::Rect find_covered_pixels(const std::vector<Polygon>& polygons, cv::Size size) {
  const auto within = [](double place, int end) { return static_cast<int>(std::clamp(place, 0.0, static_cast<double>(end))); };
  cv::Point low(size.width, size.height), high(0, 0);
  for (const Polygon& polygon : polygons)
    for (const cv::Point2d& p : polygon) {
      low = {std::min(low.x, within(std::floor(p.x), size.width)), std::min(low.y, within(std::floor(p.y), size.height))};
      high = {std::max(high.x, within(std::ceil(p.x), size.width)), std::max(high.y, within(std::ceil(p.y), size.height))};
    }
  return low.x < high.x && low.y < high.y ? cv::Rect(low, high) : cv::Rect();
}

// Sets the pixels whose centers lie in the polygon; the first pixel of the mask is `corner`.
void fill(const Polygon& polygon, cv::Point corner, cv::Mat1b& mask) {
  std::vector<double> crossings;  // crossings of the center line of a row with the edges
  // Returns the first pixel whose center is not to the left of x.
  const auto pixel = [&](double x) {
    return static_cast<int>(std::clamp(std::ceil(x - corner.x - 0.5), 0.0, static_cast<double>(mask.cols)));
  };
  for (int row = 0; row < mask.rows; ++row) {
    const double y = corner.y + row + 0.5;
    crossings.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const cv::Point2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      if ((a.y <= y) != (b.y <= y)) crossings.push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
      std::fill(mask[row] + pixel(crossings[i]), mask[row] + std::max(pixel(crossings[i]), pixel(crossings[i + 1])),
                uchar{255});
  }
}

}  // namespace

cv::Point to_drawing_pixel(double x, double y) { return {clamp_to_drawing(x), clamp_to_drawing(y)}; }

Instance to_outline(const cv::Mat1b& mask) { return to_outline(mask, {0, 0}, mask.size()); }

Instance to_outline(const cv::Mat1b& part, cv::Point corner, cv::Size size) {
  Instance out{size, {}};
  std::int64_t begun = 0;
  bool inside = false;
  const auto change = [&](int x, int y) {
    const std::int64_t at = std::int64_t{corner.x + x} * size.height + corner.y + y;
    out.runs.push_back(static_cast<std::uint32_t>(at - begun));
    begun = at;
    inside = !inside;
  };
  const bool to_the_bottom = corner.y + part.rows == size.height;
  for (int x = 0; x < part.cols; ++x) {
    if (inside && corner.y > 0) change(x, -corner.y);
    for (int y = 0; y < part.rows; ++y)
      if ((part(y, x) != 0) != inside) change(x, y);
    if (inside && !to_the_bottom) change(x, part.rows);
  }
  if (inside && corner.x + part.cols < size.width) change(part.cols, -corner.y);
  out.runs.push_back(static_cast<std::uint32_t>(std::int64_t{size.width} * size.height - begun));
  return out;
}

Instance to_outline(const std::vector<Polygon>& polygons, cv::Size size) {
  const cv::Rect part = find_covered_pixels(polygons, size);
  cv::Mat1b mask(part.size(), uchar{0});
  for (const Polygon& polygon : polygons) fill(polygon, part.tl(), mask);
  return to_outline(mask, part.tl(), size);
}

void draw(const Instance& outline, cv::Mat1b& mask) {
  const std::size_t rows = static_cast<std::size_t>(outline.size.height);
  std::size_t at = 0;
  bool inside = false;
  for (const std::uint32_t run : outline.runs) {
    const std::size_t end = at + run;
    for (std::size_t i = at; inside && i < end; ++i) {
      const int x = static_cast<int>(i / rows), y = static_cast<int>(i % rows);
      if (x < mask.cols && y < mask.rows) mask(y, x) = 255;
    }
    at = end;
    inside = !inside;
  }
}

cv::Mat1b draw_instances(const std::vector<Label>& labels, cv::Size size) {
  cv::Mat1b mask(size, uchar{0});
  for (const Label& label : labels) draw(*label.instance, mask);
  return mask;
}

bool draw_hull(const std::vector<Eigen::Vector3d>& points, const Camera& camera, cv::Mat1b& mask) {
  std::vector<Eigen::Vector2d> positions;
  for (const Eigen::Vector3d& point : points)
    if (is_beyond_near_plane(point, camera)) positions.push_back(camera.project(point));
  if (positions.empty()) return false;
  const double period = camera.period_px(), first = positions.front().x();
  if (period > 0)  // a hull across the seam of a panorama is drawn at both sides
    for (Eigen::Vector2d& p : positions) p.x() -= period * std::round((p.x() - first) / period);
  for (const double turn : {0.0, -period, period}) {
    std::vector<cv::Point> pixels, hull;
    for (const Eigen::Vector2d& p : positions) pixels.push_back(to_drawing_pixel(p.x() + turn, p.y()));
    cv::convexHull(pixels, hull);
    cv::fillConvexPoly(mask, hull, 255);
    if (period == 0) break;
  }
  return true;
}

}  // namespace dvi
