#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core/mat.hpp>

#include "dvi/core/random.h"

namespace dvi::synth {

/// Makes the random generator of one object of the street, which does not depend on other objects.
Random make_random(std::uint64_t seed, std::uint64_t kind, std::int64_t number);

/// A square of noise at all scales from one pixel to a quarter of its side. It repeats seamlessly and has unit deviation.
class Noise {
 public:
  explicit Noise(std::uint64_t seed);
  float operator()(int x, int y) const { return tile_(y & (tile_.rows - 1), x & (tile_.cols - 1)); }

 private:
  cv::Mat1f tile_;
};

/// Makes a picture of one color.
cv::Mat3b make_plain_picture(int rows, int cols, const cv::Scalar& color);
/// Adds noise; its pixel (0, 0) is that of `offset`.
void roughen(cv::Mat3b& picture, const Noise& noise, double amplitude, cv::Point offset);

/// A picture measured in meters: x to the right, z up from the lower edge. Points are (x, z); rectangles begin at their lower
/// left corner.
class Canvas {
 public:
  Canvas(double width_m, double height_m, double pixels_per_m, const cv::Scalar& color);

  cv::Mat3b picture;
  cv::Mat1b alpha;  ///< empty (no holes) until cut_below() or uncut() is called

  double width() const { return picture.cols / scale_; }
  double height() const { return picture.rows / scale_; }
  void box(const cv::Rect2d& area, const cv::Scalar& color);
  void frame(const cv::Rect2d& area, const cv::Scalar& color, int thickness);
  void line(const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color, int thickness);
  void disc(double x, double z, double radius, const cv::Scalar& color);
  /// Draws words in a box, as large as possible.
  void text(const cv::Rect2d& area, const std::string& words, const cv::Scalar& color);
  /// Makes the strip below z a hole, except for disks of uncut().
  void cut_below(double z);
  void uncut(double x, double z, double radius);

 private:
  cv::Point at(double x, double z) const;
  double scale_;
};

cv::Scalar random_color(Random& random, double low, double high);

}  // namespace dvi::synth
