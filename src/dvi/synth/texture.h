#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "dvi/core/scratch.h"

namespace dvi::synth {

/// A picture on a surface with colors at all scales, and holes. Positions are in pixels of the picture, whose corners are (0,
/// 0) and (width, height).
///
/// All textures of the process share a memory bound, beyond which they are paged to unlinked temporary files, because those of
/// a long street do not fit into memory.
class Texture {
 public:
  explicit Texture(const cv::Mat3b& picture, const cv::Mat1b& alpha = {});
  Texture(Texture&&) = default;
  Texture& operator=(Texture&&) = default;
  /// Releases textures beyond the memory bound until they are used again.
  static void page_out();

  int width() const { return levels_.front().cols; }
  int height() const { return levels_.front().rows; }
  /// Returns whether a position is not a hole. It is determined at the finest scale, so that geometry does not change with
  /// distance.
  bool solid(double x, double y) const;
  /// Returns the mean color (BGR) over the parallelogram of the two steps around a position, filtered along the longer step.
  cv::Vec3f sample(double x, double y, const Eigen::Vector2d& step_x, const Eigen::Vector2d& step_y) const;
  /// Returns the color at the finest scale.
  cv::Vec3f at(double x, double y) const { return bilinear(0, static_cast<float>(x), static_cast<float>(y)); }

 private:
  cv::Vec3f bilinear(int level, float x, float y) const;
  cv::Vec3f trilinear(float level, float x, float y) const;

  ScratchVector<cv::Vec3b> pixels_;  // the memory of all levels
  std::vector<cv::Mat3b> levels_;
  cv::Mat1b alpha_;
};

using TexturePtr = std::shared_ptr<const Texture>;

}  // namespace dvi::synth
