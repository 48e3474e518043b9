#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "dvi/core/random.h"
#include "dvi/testing/memory_views.h"

namespace dvi {

/// A test scene: a colored plane at z = 10 m, observed by cameras that are shifted sideways. A source observes the target's
/// pixel (x, y) at exactly (x + disparity, y).
struct FlatScene {
  static constexpr double kDepthM = 10;

  int width, height;
  std::vector<View> views;
  std::vector<cv::Mat3b> images;
  std::vector<cv::Mat1b> masks;

  /// Adds view 0, the target, with the image `picture`.
  FlatScene(const cv::Mat3b& picture, const cv::Mat1b& hole) : width(picture.cols), height(picture.rows) {
    add(0, picture, hole);
  }

  /// Adds a source view with `picture` shifted by `disparity` pixels. Its border is repeated outside of it.
  void add_source(int disparity, const cv::Mat3b& picture, int drive = 0) {
    cv::Mat3b image(picture.size());
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) image(y, x) = picture(y, std::clamp(x - disparity, 0, width - 1));
    add(disparity, image, cv::Mat1b(picture.size(), 0), drive);
  }

  Views lazy() const { return memory_views(views, images, masks); }
  cv::Mat1f depth() const { return cv::Mat1f(height, width, static_cast<float>(kDepthM)); }

 private:
  void add(int disparity, const cv::Mat3b& image, const cv::Mat1b& mask, int drive = 0) {
    View view;
    view.sequence = view.drive = drive;
    view.frame = views.size();
    view.time_ns = static_cast<std::int64_t>(views.size()) * 100'000'000;
    view.camera = {width, height, 100, 100, width / 2.0, height / 2.0, {}};
    view.camera_from_world.t.x() = disparity * kDepthM / view.camera.fx;
    views.push_back(view);
    images.push_back(image.clone());
    masks.push_back(mask.clone());
  }
};

/// Makes an image of smooth random colors: waves of at least `wavelength` pixels.
inline cv::Mat3b waves(int width, int height, std::uint64_t seed, double wavelength = 6) {
  constexpr int kWaves = 12;
  Random random(seed);
  double fx[kWaves], fy[kWaves], phase[kWaves][3];
  for (int k = 0; k < kWaves; ++k) {
    const double direction = random.uniform(0, 6.2832), f = 6.2832 / (wavelength * random.uniform(1, 4));
    fx[k] = f * std::cos(direction);
    fy[k] = f * std::sin(direction);
    for (double& p : phase[k]) p = random.uniform(0, 6.2832);
  }
  cv::Mat3b out(height, width);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int k = 0; k < kWaves; ++k) sum += std::sin(fx[k] * x + fy[k] * y + phase[k][c]);
        out(y, x)[c] = static_cast<uchar>(std::clamp(128 + 20 * sum, 40.0, 215.0));
      }
  return out;
}

}  // namespace dvi
