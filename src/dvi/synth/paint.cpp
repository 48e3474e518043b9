#include "dvi/synth/paint.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace dvi::synth {

Random make_random(std::uint64_t seed, std::uint64_t kind, std::int64_t number) {
  Random mix(seed * 0x9E3779B97F4A7C15ULL + kind);
  return Random(mix.next() ^ static_cast<std::uint64_t>(number) * 0xD1B54A32D192ED03ULL);
}

Noise::Noise(std::uint64_t seed) : tile_(cv::Mat1f::zeros(512, 512)) {
  struct Octave {
    int cell;
    float weight;
  };
  Random random(seed);
  const int size = tile_.cols;
  for (const Octave& octave : {Octave{1, 0.55F}, {2, 0.5F}, {4, 0.35F}, {16, 0.35F}, {64, 0.4F}, {128, 0.3F}}) {
    const int count = size / octave.cell, margin = 4;
    cv::Mat1f cells(count, count), wrapped, large;
    for (float& value : cells) value = static_cast<float>(random.normal()) * octave.weight;
    cv::copyMakeBorder(cells, wrapped, margin, margin, margin, margin, cv::BORDER_WRAP);
    cv::resize(wrapped, large, {}, octave.cell, octave.cell, cv::INTER_CUBIC);
    tile_ += large(cv::Rect(margin * octave.cell, margin * octave.cell, size, size));
  }
}

cv::Mat3b make_plain_picture(int rows, int cols, const cv::Scalar& color) {
  cv::Mat3b picture(rows, cols);
  picture.setTo(color);
  return picture;
}

void roughen(cv::Mat3b& picture, const Noise& noise, double amplitude, cv::Point offset) {
  const auto gain = static_cast<float>(amplitude);
  for (int y = 0; y < picture.rows; ++y) {
    cv::Vec3b* row = picture[y];
    for (int x = 0; x < picture.cols; ++x) {
      // Adding an offset makes the number positive, so that truncation rounds.
      const int add = static_cast<int>(gain * noise(x + offset.x, y + offset.y) + 1024.5F) - 1024;
      for (int c = 0; c < 3; ++c) row[x][c] = cv::saturate_cast<uchar>(row[x][c] + add);
    }
  }
}

Canvas::Canvas(double width_m, double height_m, double pixels_per_m, const cv::Scalar& color)
    : picture(make_plain_picture(std::max(2, static_cast<int>(std::lround(height_m * pixels_per_m))),
                                 std::max(2, static_cast<int>(std::lround(width_m * pixels_per_m))), color)),
      scale_(pixels_per_m) {}

cv::Point Canvas::at(double x, double z) const {
  return {static_cast<int>(std::lround(x * scale_)), picture.rows - static_cast<int>(std::lround(z * scale_))};
}

void Canvas::box(const cv::Rect2d& area, const cv::Scalar& color) {
  const cv::Rect rect(at(area.x, area.y + area.height), at(area.x + area.width, area.y));
  const cv::Rect inside = rect & cv::Rect({}, picture.size());
  if (!inside.empty()) cv::rectangle(picture, inside, color, cv::FILLED);
}

void Canvas::frame(const cv::Rect2d& area, const cv::Scalar& color, int thickness) {
  cv::rectangle(picture, at(area.x, area.y + area.height), at(area.x + area.width, area.y), color, thickness);
}

void Canvas::line(const cv::Point2d& from, const cv::Point2d& to, const cv::Scalar& color, int thickness) {
  cv::line(picture, at(from.x, from.y), at(to.x, to.y), color, thickness, cv::LINE_AA);
}

void Canvas::disc(double x, double z, double radius, const cv::Scalar& color) {
  cv::circle(picture, at(x, z), std::max(1, static_cast<int>(std::lround(radius * scale_))), color, cv::FILLED, cv::LINE_AA);
}

void Canvas::text(const cv::Rect2d& area, const std::string& words, const cv::Scalar& color) {
  constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
  int base = 0;
  const cv::Size size = cv::getTextSize(words, kFont, 1, 2, &base);
  const double scale = std::min(area.width * scale_ / size.width, area.height * scale_ / size.height);
  const double left = area.x + 0.5 * (area.width - size.width * scale / scale_);
  const double bottom = area.y + 0.5 * (area.height - size.height * scale / scale_);
  cv::putText(picture, words, at(left, bottom), kFont, scale, color, std::max(1, static_cast<int>(scale * 2.2)), cv::LINE_AA);
}

void Canvas::cut_below(double z) {
  alpha = cv::Mat1b(picture.size(), 255);
  alpha.rowRange(at(0, z).y, alpha.rows).setTo(0);
}

void Canvas::uncut(double x, double z, double radius) {
  cv::circle(alpha, at(x, z), static_cast<int>(radius * scale_), 255, cv::FILLED);
}

cv::Scalar random_color(Random& random, double low, double high) {
  const double b = random.uniform(low, high), g = random.uniform(low, high);
  return {b, g, random.uniform(low, high)};
}

}  // namespace dvi::synth
